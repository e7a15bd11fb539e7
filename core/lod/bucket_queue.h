// A priority queue for many changing costs that need no exact order.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace orbis::lod {

// Items by their `cost`, a float that is not negative. Costs that agree in sign, exponent and the first seven bits of
// the mantissa, so differ by less than 1 %, come in the order in which they were put in: on a flat part of a surface,
// where all cost nothing, that goes round and round instead of growing one vertex. A step costs O(1), and touches the
// ends of one bucket, where a heap of millions misses the cache on every level.
template <class Item> class BucketQueue {
public:
  BucketQueue() : buckets_(bucket_of(std::numeric_limits<float>::infinity()) + 1) {}

  [[nodiscard]] bool is_empty() const { return size_ == 0; }

  void push(const Item& item) {
    const std::size_t bucket = bucket_of(item.cost);
    buckets_[bucket].items.push_back(item);
    first_ = std::min(first_, bucket);
    ++size_;
  }

  // The next item of a queue that is not empty.
  [[nodiscard]] const Item& top() {
    while (buckets_[first_].next == buckets_[first_].items.size()) ++first_;
    return buckets_[first_].items[buckets_[first_].next];
  }

  // Takes what top() gives.
  void pop() {
    static_cast<void>(top());
    Bucket& bucket = buckets_[first_];
    --size_;
    if (++bucket.next < bucket.items.size()) return;
    bucket.items.clear();
    bucket.next = 0;
  }

  void clear() { *this = {}; }

private:
  struct Bucket {
    std::vector<Item> items;
    std::size_t next = 0; // those before it are gone
  };

  static std::size_t bucket_of(float cost) { return std::bit_cast<std::uint32_t>(cost) >> 16U; }

  std::vector<Bucket> buckets_;
  std::size_t first_ = 0, size_ = 0; // no item lies before `first_`
};

} // namespace orbis::lod
