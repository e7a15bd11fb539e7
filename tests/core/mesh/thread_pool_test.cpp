#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/mesh/thread_pool.h"

using orbis::mesh::ThreadPool;

TEST_CASE("every element is visited once, with any number of threads") {
  for (const std::uint32_t threads : {1U, 2U, 5U}) {
    ThreadPool pool(threads);
    CHECK(pool.size() == threads);
    for (const std::size_t count : {0U, 1U, 63U, 64U, 1000U}) {
      std::vector<int> visits(count, 0);
      pool.for_blocks(count, 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      CHECK(std::ranges::count(visits, 1) == static_cast<std::ptrdiff_t>(count));
    }
  }
}

TEST_CASE("sums have the same bits with any number of threads") {
  const auto sum_with = [](std::uint32_t threads) {
    ThreadPool pool(threads);
    return pool.sum_blocks(100'000, 256, [](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t i = begin; i < end; ++i) sum += std::sin(static_cast<double>(i));
      return sum;
    });
  };
  CHECK(sum_with(1) == sum_with(2));
  CHECK(sum_with(1) == sum_with(7));
}
