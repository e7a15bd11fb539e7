// SIGTERM and SIGINT as a function call.
#pragma once

#include <functional>
#include <thread>

namespace orbis::server {

// While it lives, SIGTERM and SIGINT call `action` on a thread of its own, with 1, 2, … for the first, second, …
// signal. Create it before any other thread, so that they all leave the signals to it.
class SignalWatch {
public:
  explicit SignalWatch(std::function<void(int count)> action);

private:
  std::jthread thread_;
};

} // namespace orbis::server
