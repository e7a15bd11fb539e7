#include "core/mesh/thread_pool.h"

namespace orbis::mesh {

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
  {
    const std::lock_guard lock(mutex_);
    block_ = &block;
    blocks_ = blocks;
    next_ = 0;
    busy_ = workers_.size();
    ++generation_;
  }
  start_.notify_all();
  work(block, blocks);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return busy_ == 0; });
  block_ = nullptr;
}

void ThreadPool::work(const std::function<void(std::size_t)>& block, std::size_t blocks) {
  for (std::size_t i = next_++; i < blocks; i = next_++) block(i);
}

void ThreadPool::loop() {
  std::uint64_t seen = 0;
  std::unique_lock lock(mutex_);
  while (true) {
    start_.wait(lock, [&] { return stopping_ || generation_ != seen; });
    if (stopping_) return;
    seen = generation_;
    const auto* block = block_;
    const std::size_t blocks = blocks_;
    lock.unlock();
    work(*block, blocks);
    lock.lock();
    if (--busy_ == 0) done_.notify_one();
  }
}

} // namespace orbis::mesh
