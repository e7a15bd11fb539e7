#include "core/mesh/thread_pool.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace orbis::mesh {
namespace {

// Loops follow one another within microseconds, and to wake a sleeping thread takes tens of them: who waits looks again
// for about as long before it goes to sleep.
constexpr int looks = 1000;

void pause_a_little() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

template <class Condition> bool comes_soon(const Condition& condition) {
  for (int i = 0; i < looks; ++i) {
    if (condition()) return true;
    pause_a_little();
  }
  return false;
}

} // namespace

ThreadPool::ThreadPool(std::uint32_t threads) {
  const std::uint32_t wanted = threads != 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
  for (std::uint32_t i = 1; i < wanted; ++i) workers_.emplace_back([this] { loop(); });
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  start_.notify_all();
  for (std::thread& worker : workers_) worker.join();
}

void ThreadPool::run(std::size_t blocks, const std::function<void(std::size_t)>& block) {
  block_ = &block;
  blocks_ = blocks;
  next_ = 0;
  busy_ = workers_.size();
  {
    const std::lock_guard lock(mutex_);
    ++generation_;
  }
  start_.notify_all();
  work(block, blocks);
  const auto all_left = [this] { return busy_ == 0; };
  if (comes_soon(all_left)) return;
  std::unique_lock lock(mutex_);
  done_.wait(lock, all_left);
}

void ThreadPool::work(const std::function<void(std::size_t)>& block, std::size_t blocks) {
  for (std::size_t i = next_++; i < blocks; i = next_++) block(i);
}

void ThreadPool::loop() {
  std::uint64_t seen = 0;
  const auto called = [&] { return stopping_ || generation_ != seen; };
  while (true) {
    if (!comes_soon(called)) {
      std::unique_lock lock(mutex_);
      start_.wait(lock, called);
    }
    if (stopping_) return;
    seen = generation_;
    work(*block_, blocks_);
    if (--busy_ == 0) {
      // The caller may be between its look and its sleep: it holds the mutex there.
      const std::lock_guard lock(mutex_);
      done_.notify_one();
    }
  }
}

} // namespace orbis::mesh
