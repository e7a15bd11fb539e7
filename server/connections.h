// Which connections are open, and which ones to give up when others wait.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <list>
#include <mutex>
#include <stop_token>

namespace orbis::server {

// Thread-safe.
class Connections {
public:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    int socket;
    Clock::time_point since; // of the present phase
    bool working = false;    // we owe it an answer; else it owes us bytes, or is slow to take ours
    bool closing = false;
  };
  using Handle = std::list<Entry>::iterator;

  // limit: connections that are served at a time; more wait for a place.
  explicit Connections(std::size_t limit) : limit_(limit) {}

  void accepted();
  // The connection that has waited longest gets its place.
  [[nodiscard]] Handle open(int socket);
  void close(Handle connection);
  void set_working(Handle connection, bool working);

  // Where all places are taken and others wait: shuts down as many connections as wait, those first that have been
  // longest without work for us, and none that has been so for less than `grace`.
  void make_room(Clock::time_point time);
  // Does so for as long as others wait, until the stop.
  void make_room_until(const std::stop_token& stop);

  static constexpr std::chrono::milliseconds grace{100};

private:
  std::size_t limit_;
  std::mutex mutex_;
  std::condition_variable_any waiting_changed_;
  std::list<Entry> entries_;
  std::size_t waiting_ = 0;
};

} // namespace orbis::server
