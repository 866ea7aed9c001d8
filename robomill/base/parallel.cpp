#include "robomill/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

#ifdef ROBOMILL_TBB
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#else
#include <exception>
#include <mutex>
#include <vector>
#endif

namespace robomill {
namespace {

std::atomic<int>& requested_threads() {
  static std::atomic<int> threads{0};
  return threads;
}

thread_local int most_threads = std::numeric_limits<int>::max();

}  // namespace

ThreadLimit::ThreadLimit(int most) : before_(most_threads) {
  most_threads = std::clamp(most, 1, before_);
}

ThreadLimit::~ThreadLimit() {
  most_threads = before_;
}

void set_thread_count(int threads) {
  requested_threads() = std::max(threads, 0);
}

int thread_count() {
  static const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));  // reads files
  const int requested = requested_threads();
  const int threads = requested > 0 ? requested : cores;
  return std::min(threads, most_threads);
}

void parallel_for(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (n == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t blocks = (n + grain - 1) / grain;
  const auto run = [&](std::size_t block) { body(block * grain, std::min(n, (block + 1) * grain)); };
  const int threads = thread_count();
  if (threads == 1 || blocks == 1) {
    for (std::size_t block = 0; block < blocks; ++block) run(block);
    return;
  }
#ifdef ROBOMILL_TBB
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, blocks, run, tbb::simple_partitioner{}); });
#else
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  {
    std::vector<std::jthread> workers;
    const std::size_t count = std::min(blocks, static_cast<std::size_t>(threads));
    for (std::size_t i = 0; i < count; ++i) {
      workers.emplace_back([&] {
        for (std::size_t block = next++; block < blocks; block = next++) {
          try {
            run(block);
          } catch (...) {
            const std::lock_guard lock(failure_mutex);
            if (!failure) failure = std::current_exception();
            next = blocks;
          }
        }
      });
    }
  }
  if (failure) std::rethrow_exception(failure);
#endif
}

}  // namespace robomill
