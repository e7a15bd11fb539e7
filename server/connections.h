// Which connections are open, and which one to give up when there are too many.
#pragma once

#include <chrono>
#include <cstddef>
#include <list>
#include <mutex>

namespace orbis::server {

// Thread-safe.
class Connections {
public:
  struct Entry {
    int socket;
    std::chrono::steady_clock::time_point since; // of the present phase
    bool working = false;                        // we owe it an answer; else it owes us bytes, or is slow to take ours
    bool closing = false;
  };
  using Handle = std::list<Entry>::iterator;

  explicit Connections(std::size_t limit) : limit_(limit) {}

  [[nodiscard]] Handle open(int socket);
  void close(Handle connection);
  void set_working(Handle connection, bool working);
  // Shuts down the socket of the connection that has been longest without work, if the limit is reached.
  void make_room();

private:
  std::size_t limit_;
  std::mutex mutex_;
  std::list<Entry> entries_;
};

} // namespace orbis::server
