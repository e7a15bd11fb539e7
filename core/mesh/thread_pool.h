// A few threads that share loops over independent elements. Results never depend on their number: every element is
// written by one call, and sums go over fixed blocks.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

namespace orbis::mesh {

class ThreadPool {
public:
  // threads: 0 for as many as the machine has. One thread starts none: loops then run in the caller.
  explicit ThreadPool(std::uint32_t threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  [[nodiscard]] std::size_t size() const { return workers_.size() + 1; }

  // How std::async runs work beside the caller's: on a thread of its own, or with one thread when its result is asked
  // for.
  [[nodiscard]] std::launch beside() const { return workers_.empty() ? std::launch::deferred : std::launch::async; }

  // Calls body(begin, end) for blocks that cover [0, count); blocks are `grain` elements, the last may be shorter.
  // Small loops run in the caller. body must not throw and not touch what another block writes.
  template <class Body> void for_blocks(std::size_t count, std::size_t grain, Body&& body) {
    const std::size_t blocks = (count + grain - 1) / grain;
    const auto one = [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); };
    if (workers_.empty() || blocks < 2) {
      for (std::size_t i = 0; i < blocks; ++i) one(i);
    } else {
      run(blocks, one);
    }
  }

  // Sum of term(begin, end) over blocks, added in the order of the blocks: the same bits with any number of threads.
  template <class Term> double sum_blocks(std::size_t count, std::size_t grain, Term&& term) {
    std::vector<double> sums((count + grain - 1) / grain);
    for_blocks(count, grain, [&](std::size_t begin, std::size_t end) { sums[begin / grain] = term(begin, end); });
    double sum = 0;
    for (const double s : sums) sum += s;
    return sum;
  }

private:
  void run(std::size_t blocks, const std::function<void(std::size_t)>& block);
  void work(const std::function<void(std::size_t)>& block, std::size_t blocks);
  void loop();

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable start_, done_;
  const std::function<void(std::size_t)>* block_ = nullptr; // the current loop, until all threads have left it
  std::size_t blocks_ = 0;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> busy_{0};
  std::atomic<std::uint64_t> generation_{0}; // of the current loop; written with the mutex held, for who sleeps
  std::atomic<bool> stopping_{false};
};

} // namespace orbis::mesh
