#include "server/signals.h"

#include <pthread.h>

#include <csignal>
#include <ctime>

namespace orbis::server {

SignalWatch::SignalWatch(std::function<void(int)> action) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGPIPE, SIG_IGN); // a reader that went away is an error of its write
  thread_ = std::jthread([signals, action = std::move(action)](const std::stop_token& stop) {
    int count = 0;
    while (!stop.stop_requested()) {
      const timespec pause{0, 100'000'000};
      if (sigtimedwait(&signals, nullptr, &pause) > 0) action(++count);
    }
  });
}

} // namespace orbis::server
