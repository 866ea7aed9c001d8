#include "robomill/serve/worker.hpp"

#include <gtest/gtest.h>

#include <future>
#include <new>
#include <stdexcept>

namespace robomill::serve {
namespace worker_test {

TEST(Worker, GoesOnAfterATaskThatThrows) {
  Worker worker(8);
  ASSERT_TRUE(worker.post([] { throw std::runtime_error("an error"); }));
  ASSERT_TRUE(worker.post([] { throw std::bad_alloc(); }));
  std::promise<int> done;
  ASSERT_TRUE(worker.post([&] { done.set_value(7); }));
  EXPECT_EQ(done.get_future().get(), 7);
}

}  // namespace worker_test
}  // namespace robomill::serve
