#include "server/connections.h"

#include <sys/socket.h>

#include <algorithm>
#include <vector>

namespace orbis::server {

void Connections::accepted() {
  const std::scoped_lock lock(mutex_);
  ++waiting_;
  waiting_changed_.notify_one();
}

Connections::Handle Connections::open(int socket) {
  const std::scoped_lock lock(mutex_);
  --waiting_;
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

void Connections::make_room(Clock::time_point time) {
  const std::scoped_lock lock(mutex_);
  const auto closing = static_cast<std::size_t>(std::ranges::count(entries_, true, &Entry::closing));
  if (entries_.size() < limit_ || waiting_ <= closing) return;
  std::vector<Entry*> slow;
  for (Entry& entry : entries_) {
    if (!entry.working && !entry.closing && time - entry.since >= grace) slow.push_back(&entry);
  }
  std::ranges::sort(slow, {}, &Entry::since);
  slow.resize(std::min(slow.size(), waiting_ - closing));
  for (Entry* entry : slow) {
    entry->closing = true;
    ::shutdown(entry->socket, SHUT_RDWR); // its thread sees the end of the stream and closes it
  }
}

void Connections::make_room_until(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    make_room(Clock::now());
    std::unique_lock lock(mutex_);
    // Most that wait get their place at once: look again soon, not immediately.
    if (waiting_changed_.wait(lock, stop, [this] { return waiting_ > 0; })) {
      waiting_changed_.wait_for(lock, stop, std::chrono::milliseconds(20), [] { return false; });
    }
  }
}

} // namespace orbis::server
