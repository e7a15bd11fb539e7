#include "core/lod/bucket_queue.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

using namespace orbis;

namespace {

struct Item {
  float cost;
  std::uint32_t number;
};

std::vector<Item> drained(lod::BucketQueue<Item>& queue) {
  std::vector<Item> out;
  while (!queue.is_empty()) {
    out.push_back(queue.top());
    queue.pop();
  }
  return out;
}

} // namespace

TEST_CASE("costs come out in order, to one per cent") {
  std::mt19937 random(1);
  std::lognormal_distribution<float> any(-20, 10);
  lod::BucketQueue<Item> queue;
  for (std::uint32_t i = 0; i < 10'000; ++i) queue.push({any(random), i});
  const std::vector<Item> out = drained(queue);
  REQUIRE(out.size() == 10'000);
  std::vector<bool> seen(out.size());
  float largest = 0;
  for (const Item& item : out) {
    CHECK(item.cost >= 0.992F * largest);
    largest = std::max(largest, item.cost);
    seen[item.number] = true;
  }
  CHECK(std::find(seen.begin(), seen.end(), false) == seen.end());
}

TEST_CASE("equal costs come out in the order in which they went in, also while more are put in") {
  lod::BucketQueue<Item> queue;
  for (std::uint32_t i = 0; i < 4; ++i) queue.push({0, i});
  CHECK(queue.top().number == 0);
  queue.pop();
  queue.push({0, 4});
  std::uint32_t expected = 1;
  for (const Item& item : drained(queue)) CHECK(item.number == expected++);
  CHECK(expected == 5);
}

TEST_CASE("a cheaper item that comes later goes first, and the extremes of a float have their places") {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  lod::BucketQueue<Item> queue;
  queue.push({infinity, 0});
  queue.push({1, 1});
  CHECK(queue.top().number == 1);
  queue.pop();
  queue.push({std::numeric_limits<float>::denorm_min(), 2});
  queue.push({std::numeric_limits<float>::max(), 3});
  CHECK(queue.top().number == 2);
  queue.pop();
  CHECK(queue.top().number == 3);
  queue.pop();
  CHECK(queue.top().number == 0);
  queue.clear();
  CHECK(queue.is_empty());
}
