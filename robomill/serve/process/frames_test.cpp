#include "robomill/serve/process/frames.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace robomill::serve {
namespace frames_test {

/// What send_frame() sends.
std::string sent(const std::vector<Frame>& frames) {
  std::array<int, 2> ends = {};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  for (const Frame& frame : frames) EXPECT_TRUE(send_frame(ends[0], frame.kind, frame.body));
  ::close(ends[0]);
  std::string out;
  std::array<char, 4096> block = {};
  for (ssize_t count = 0; (count = ::recv(ends[1], block.data(), block.size(), 0)) > 0;) {
    out.append(block.data(), static_cast<std::size_t>(count));
  }
  ::close(ends[1]);
  return out;
}

TEST(Frames, ComeOutOfAnyPieces) {
  const std::vector<Frame> frames = {
      {Frame::job, "{\"verb\": \"plan\"}"}, {Frame::stop, ""}, {Frame::answer, "200 {}"}};
  const std::string bytes = sent(frames);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    FrameReader reader(100);
    std::vector<Frame> read;
    const auto take = [&] {
      while (std::optional<Frame> frame = reader.next()) read.push_back(*frame);
    };
    reader.add(bytes.substr(0, cut));
    take();
    reader.add(bytes.substr(cut));
    take();
    ASSERT_EQ(read.size(), frames.size()) << cut;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(read[i].kind, frames[i].kind) << cut;
      EXPECT_EQ(read[i].body, frames[i].body) << cut;
    }
  }
}

TEST(Frames, OneThatIsTooLongIsNotWaitedFor) {
  FrameReader reader(10);
  reader.add(sent({{Frame::answer, "0123456789"}}));
  ASSERT_TRUE(reader.next().has_value());
  reader.add(sent({{Frame::answer, "0123456789+"}}).substr(0, 5));
  EXPECT_THROW(static_cast<void>(reader.next()), std::length_error);
}

TEST(Frames, SaysThatNobodyIsThere) {
  std::array<int, 2> ends = {};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  ::close(ends[1]);
  EXPECT_FALSE(send_frame(ends[0], Frame::stop, {}));
  ::close(ends[0]);
}

}  // namespace frames_test
}  // namespace robomill::serve
