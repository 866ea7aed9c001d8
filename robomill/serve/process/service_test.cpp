// The server's end, before shells in the place of workers.
#include "robomill/serve/process/service.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/serve/process/monitor_service.hpp"

namespace robomill::serve {
namespace service_test {

/// A process of shell commands, whose socket is descriptor 3, and what came of it.
class ServiceTest : public ::testing::Test {
 protected:
  static WorkerOptions shell(const std::string& commands) {
    return {.command = {"/bin/sh", "-c", commands}, .root = "/"};
  }
  void start(const std::string& commands) {
    service_ = std::make_unique<Service>(
        shell(commands),
        [this](std::string_view event, std::string_view data) {
          const std::lock_guard lock(mutex_);
          events_.push_back(std::string(event) + "|" + std::string(data));
        },
        [this] {
          const std::lock_guard lock(mutex_);
          events_.emplace_back("died");
        });
  }
  [[nodiscard]] std::vector<std::string> events(std::size_t count) {
    for (int tries = 0; tries < 6000; ++tries) {
      {
        const std::lock_guard lock(mutex_);
        if (events_.size() >= count) return events_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return {};
  }
  [[nodiscard]] std::string asked() {
    try {
      return service_->ask(Frame::monitors, "GET /api/monitors\n").body;
    } catch (const WorkerEnded& error) {
      return error.what();
    }
  }

  std::mutex mutex_;
  std::vector<std::string> events_;
  std::unique_ptr<Service> service_;
};

TEST_F(ServiceTest, HasNewsOfItsOwn) {
  // An event of 7 bytes, one whose data would be two lines, and the answer to the question.
  start(
      "printf 'e\\007\\000\\000\\000tap\\n{a}' >&3; printf 'e\\010\\000\\000\\000tap\\nb\\nc\\n' >&3; "
      "grep -a -m 1 monitors <&3 >/dev/null; printf 'a\\006\\000\\000\\000200 {}' >&3; exec cat <&3 >/dev/null");
  EXPECT_EQ(asked(), "{}");
  EXPECT_EQ(events(1), std::vector<std::string>{"tap|{a}"});
  EXPECT_FALSE(service_->fate().has_value());
  service_.reset();
  EXPECT_EQ(events(1).size(), 1U);  // its end is no news where it was wanted
}

TEST_F(ServiceTest, SaysWhatItDiedOf) {
  start("head -c 1 <&3 >/dev/null; kill -KILL $$");
  EXPECT_NE(asked().find("was killed"), std::string::npos);
  EXPECT_EQ(events(1), std::vector<std::string>{"died"});
  EXPECT_NE(asked().find("was killed"), std::string::npos);
  EXPECT_NE(service_->fate().value_or("").find("was killed"), std::string::npos);
}

TEST_F(ServiceTest, EndsWhereItCannotBeUnderstood) {
  start("echo hello, server >&3; exec cat <&3 >/dev/null");
  EXPECT_EQ(events(1), std::vector<std::string>{"died"});
  EXPECT_NE(asked().find("cannot be understood"), std::string::npos);
}

TEST_F(ServiceTest, IsEndedWhileItIsAsked) {
  start("exec sleep 600");
  std::thread later([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    service_->end();
  });
  EXPECT_NE(asked().find("its process"), std::string::npos);  // and not after a minute
  later.join();
  service_.reset();
  EXPECT_TRUE(events_.empty());
}

TEST(MonitorServiceTest, ForwardsRequests) {
  const HttpRequest request = {
      .method = "POST", .path = "/api/monitors", .query = {}, .headers = {}, .body = "{\"a\": 1}\n"};
  const HttpRequest read = http_request_of(text_of(request));
  EXPECT_EQ(read.method, request.method);
  EXPECT_EQ(read.path, request.path);
  EXPECT_EQ(read.body, request.body);
  for (const char* text : {"", " ", "\n", "GET", "GET \n"}) EXPECT_EQ(http_request_of(text).body, "") << text;
}

}  // namespace service_test
}  // namespace robomill::serve
