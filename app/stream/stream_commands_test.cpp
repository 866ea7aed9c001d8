// Commands of a stream: words, hostile text, and whoever connects.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <string>
#include <vector>

#include "app/stream/command_intake.hpp"
#include "app/stream/commands.hpp"
#include "robomill/base/random.hpp"
#include "testing/processes.hpp"
#include "testing/support.hpp"

namespace robomill::app {
namespace stream_commands_test {

using Kind = StreamCommand::Kind;

TEST(StreamCommands, AreWords) {
  const std::pair<const char*, Kind> plain[] = {
      {"hold", Kind::hold}, {" resume\r", Kind::resume}, {"\tstop ", Kind::stop}, {"status", Kind::status}};
  for (const auto& [text, kind] : plain) {
    const ParsedCommand parsed = parse_command(text);
    ASSERT_TRUE(parsed.command) << text << parsed.error;
    EXPECT_EQ(parsed.command->kind, kind);
  }
  const std::pair<const char*, double> overrides[] = {
      {"override 0.5", 0.5}, {"override  1.5 ", 1.5}, {"override\t0", 0.0}, {"override 1e-1", 0.1}};
  for (const auto& [text, share] : overrides) {
    const ParsedCommand parsed = parse_command(text);
    ASSERT_TRUE(parsed.command) << text << parsed.error;
    EXPECT_EQ(parsed.command->kind, Kind::feed_override);
    EXPECT_EQ(parsed.command->share, share);
  }
  for (const char* const empty : {"", "  ", "\r"}) {
    EXPECT_FALSE(parse_command(empty).command);
    EXPECT_EQ(parse_command(empty).error, "");
  }
}

TEST(StreamCommands, AreRejectedInOneLine) {
  const std::vector<std::string> bad = {"Hold",          "hold on",        "override",       "override 1.51",
                                        "override -0.1", "override nan",   "override inf",   "override 0.5 0.6",
                                        "override 50%",  "override 1e400", "stop;hold",      std::string("ho\0ld", 5),
                                        "\x1b[2J",       "\xff\xfe",       "GET / HTTP/1.1", std::string(200, 'x')};
  for (const std::string& text : bad) {
    const ParsedCommand parsed = parse_command(text);
    EXPECT_FALSE(parsed.command) << text;
    EXPECT_FALSE(parsed.error.empty()) << text;
    for (const char letter : parsed.error) EXPECT_GE(static_cast<unsigned char>(letter), 0x20U) << text;
  }
  EXPECT_EQ(parse_command("override 2").error,
            "override must be a share of the programmed feed from 0 to 1.5, not \"2\"; 0.5 is half");
  EXPECT_EQ(parse_command("hlod").error,
            "\"hlod\" is no command; known are hold, resume, override SHARE, stop, status");
}

// However bytes are cut, the lines are the same; and no line is longer than it may be.
TEST(StreamCommands, LinesDoNotDependOnHowTheyCome) {
  std::string bytes;
  Random random(1, 61);
  for (int i = 0; i < 300; ++i) {
    const std::size_t length = random.uniform() < 0.1 ? 150 + random.index(300) : random.index(20);
    for (std::size_t k = 0; k < length; ++k) {
      const char letter = static_cast<char>(random.index(256));
      bytes += letter == '\n' ? ' ' : letter;
    }
    bytes += '\n';
  }
  bytes += "stop";
  const auto lines_in = [&](std::size_t most) {
    CommandLines lines;
    std::vector<std::string> out;
    const auto take = [&](std::optional<std::string_view> line) {
      EXPECT_TRUE(!line || line->size() <= CommandLines::longest);
      out.push_back(line ? "=" + std::string(*line) : "too long");
    };
    for (std::size_t at = 0; at < bytes.size();) {
      const std::size_t count = std::min(bytes.size() - at, 1 + random.index(most));
      lines.add(std::string_view(bytes).substr(at, count), take);
      at += count;
    }
    lines.end(take);
    return out;
  };
  const std::vector<std::string> whole = lines_in(bytes.size());
  EXPECT_EQ(whole.size(), 301U);
  EXPECT_EQ(whole.back(), "=stop");
  EXPECT_GT(std::count(whole.begin(), whole.end(), "too long"), 5);
  for (const std::size_t most : {std::size_t{1}, std::size_t{7}, std::size_t{512}}) EXPECT_EQ(lines_in(most), whole);
}

/// What answers a line with itself.
struct Echo {
  explicit Echo(const std::string& listen, int input = -1)
      : intake(
            {.input = input, .listen = listen},
            [this](std::optional<std::string_view> line) {
              taken.push_back(line ? std::string(*line) : "too long");
              return "ok " + taken.back();
            },
            [this](const std::string& answer) { printed.push_back(answer); }) {}
  void run() {
    for (int i = 0; i < 20; ++i) intake.poll(std::chrono::milliseconds(5));
  }
  std::vector<std::string> taken = {}, printed = {};
  CommandIntake intake;
};

int connected(const std::string& address) {
  int socket = -1;
  if (address.find('/') != std::string::npos) {
    sockaddr_un at = {};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, address.data(), address.size());
    socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  } else {
    sockaddr_in at = {};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  }
  return socket;
}

void send_text(int socket, const std::string& text) {
  EXPECT_EQ(::send(socket, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
}

std::string received(int socket) {
  std::array<char, 4096> bytes = {};
  const ssize_t count = ::recv(socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
  return count > 0 ? std::string(bytes.data(), static_cast<std::size_t>(count)) : count == 0 ? "closed" : "nothing";
}

TEST(CommandIntake, AnswersEachLine) {
  const robomill::test::Folder folder;
  const std::string path = (folder.path() / "c.sock").string();
  for (const std::string& place : {std::string("0"), std::string("localhost:0"), path}) {
    Echo echo(place);
    EXPECT_FALSE(echo.intake.is_public());
    const int one = connected(echo.intake.address()), other = connected(echo.intake.address());
    echo.run();
    send_text(one, "hold\nover");
    send_text(other, std::string(3000, 'x') + "\nstatus\n");
    echo.run();
    EXPECT_EQ(received(one), "ok hold\n");
    EXPECT_EQ(received(other), "ok too long\nok status\n");
    send_text(one, "ride 0.5\r\nstop");
    ::shutdown(one, SHUT_WR);
    echo.run();
    EXPECT_EQ(received(one), "ok override 0.5\r\nok stop\n");
    EXPECT_EQ(received(one), "closed");
    // A page in a browser gets nothing done.
    send_text(other, "POST / HTTP/1.1\nHost: x\n\nstop\n");
    const std::size_t before = echo.taken.size();
    echo.run();
    EXPECT_EQ(echo.taken.size(), before);
    EXPECT_EQ(received(other), "closed");
    ::close(one);
    ::close(other);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(CommandIntake, ReadsADescriptorToItsEnd) {
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  Echo echo("", ends[0]);
  ASSERT_EQ(::write(ends[1], "hold\nstop", 9), 9);
  ::close(ends[1]);
  echo.run();
  EXPECT_EQ(echo.printed, (std::vector<std::string>{"ok hold", "ok stop"}));
  EXPECT_EQ(echo.intake.address(), "");
  ::close(ends[0]);
}

TEST(CommandIntake, TakesAFewConnections) {
  Echo echo("0");
  std::vector<int> sockets;
  for (std::size_t i = 0; i < CommandIntake::most_clients + 1; ++i) {
    sockets.push_back(connected(echo.intake.address()));
    echo.run();
  }
  EXPECT_EQ(received(sockets.back()), "error: too many connections\n");
  send_text(sockets.front(), "hold\n");
  echo.run();
  EXPECT_EQ(received(sockets.front()), "ok hold\n");
  for (const int socket : sockets) ::close(socket);
}

// Who does not read the answers does not hold up the stream: the connection ends.
TEST(CommandIntake, EndsAConnectionThatReadsNothing) {
  Echo echo("0");
  const int socket = connected(echo.intake.address());
  std::string many;
  for (int i = 0; i < 2000; ++i) many += std::string(100, 'x') + "\n";
  ssize_t sent = 0;
  for (int i = 0; i < 300'000 && sent >= 0; ++i) {
    sent = ::send(socket, many.data(), many.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && errno == EAGAIN) sent = 0;
    echo.intake.poll(std::chrono::milliseconds(0));
  }
  EXPECT_LT(sent, 0);
  ::close(socket);
}

TEST(CommandIntake, RejectsBadPlaces) {
  const robomill::test::Folder folder;
  const std::string file = (folder.path() / "file").string(), dead = (folder.path() / "dead").string();
  folder.file("file", "kept");
  const std::vector<std::string> places = {
      "x",     "70000", "-1",           "1.2.3:80",          "127.0.0.1:",
      "5005x", file,    "8.8.8.8:5005", "/no/such/folder/s", "/" + std::string(300, 's')};
  for (const std::string& place : places) {
    EXPECT_EQ(robomill::test::field_of([&] { const Echo echo(place); }), "--listen") << place;
  }
  EXPECT_EQ(robomill::test::slurp(file), "kept");
  // One that is in use, and one that a process left behind.
  const Echo first(dead);
  EXPECT_EQ(robomill::test::field_of([&] { const Echo echo(dead); }), "--listen");
  const std::string left = (folder.path() / "left").string();
  sockaddr_un at = {};
  at.sun_family = AF_UNIX;
  std::memcpy(at.sun_path, left.data(), left.size());
  const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&at), sizeof(at)), 0);
  ::close(socket);
  const Echo second(left);
  EXPECT_EQ(second.intake.address(), left);
  struct stat found = {};
  ASSERT_EQ(::stat(left.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777U, 0600U);  // others cannot connect
}

}  // namespace stream_commands_test
}  // namespace robomill::app
