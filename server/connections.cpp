#include "server/connections.h"

#include <sys/socket.h>

#include <algorithm>

namespace orbis::server {

using Clock = std::chrono::steady_clock;

Connections::Handle Connections::open(int socket) {
  const std::scoped_lock lock(mutex_);
  return entries_.insert(entries_.end(), Entry{socket, Clock::now()});
}

void Connections::close(Handle connection) {
  const std::scoped_lock lock(mutex_);
  entries_.erase(connection);
}

void Connections::set_working(Handle connection, bool working) {
  const std::scoped_lock lock(mutex_);
  connection->working = working;
  connection->since = Clock::now();
}

void Connections::make_room() {
  const std::scoped_lock lock(mutex_);
  const auto open = std::ranges::count(entries_, false, &Entry::closing);
  if (static_cast<std::size_t>(open) < limit_) return;
  const auto slower = [](const Entry& a, const Entry& b) {
    const auto busy = [](const Entry& e) { return e.working || e.closing; };
    return busy(a) != busy(b) ? !busy(a) : a.since < b.since;
  };
  const auto slowest = std::ranges::min_element(entries_, slower);
  if (slowest == entries_.end() || slowest->working || slowest->closing) return;
  slowest->closing = true;
  ::shutdown(slowest->socket, SHUT_RDWR); // its thread sees the end of the stream and closes it
}

} // namespace orbis::server
