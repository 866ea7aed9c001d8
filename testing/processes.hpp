#pragma once
// For tests: programs that run beside the test, a broker among them.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace robomill::test {

/// Waits for something to be so; false where it is not within a minute, which only a fault takes.
template <class Condition>
bool wait_for(Condition&& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A program in the background; ended with the test.
class Process {
 public:
  Process(std::vector<std::string> arguments, const std::filesystem::path& out, const std::filesystem::path& err) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    // What whoever runs the tests ignores is not ignored here.
    sigset_t defaulted;
    sigemptyset(&defaulted);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&defaulted, number);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigdefault(&attributes, &defaulted);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    std::vector<char*> words;
    for (std::string& argument : arguments) words.push_back(argument.data());
    words.push_back(nullptr);
    if (posix_spawnp(&pid_, words.front(), &actions, &attributes, words.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  ~Process() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    (void)wait();
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  [[nodiscard]] bool started() const { return pid_ > 0; }
  [[nodiscard]] pid_t pid() const { return pid_; }
  void signal(int number) const { ::kill(pid_, number); }
  /// The exit code; 128 and the signal where one ended it.
  int wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  [[nodiscard]] bool running() const {
    siginfo_t info = {};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
  }

 private:
  pid_t pid_ = -1;
};

inline sockaddr_in loopback(int port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

/// One that nobody listens at.
inline int free_port() {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof(address);
  ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
  ::close(descriptor);
  return ntohs(address.sin_port);
}

inline bool listens(int port) {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = loopback(port);
  const bool connected = ::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(descriptor);
  return connected;
}

/// mosquitto on a free port of loopback.
class Mosquitto {
 public:
  /// @param more  lines of its configuration; without any everyone may connect
  explicit Mosquitto(std::filesystem::path folder, std::string more = "allow_anonymous true\n")
      : folder_(std::move(folder)), more_(std::move(more)) {
    // Another program may take the port in between: then the next one.
    for (int attempt = 0; attempt < 5 && process_ == nullptr; ++attempt) {
      port_ = free_port();
      start();
    }
    if (process_ == nullptr) throw std::runtime_error("is mosquitto installed? " + slurp(folder_ / "mosquitto.err"));
  }

  void start() {
    std::ofstream(folder_ / "mosquitto.conf") << "listener " << port_ << " 127.0.0.1\npersistence false\nuser root\n"
                                              << more_;
    // Debian has it where a user's path does not lead.
    const char* program = std::filesystem::exists("/usr/sbin/mosquitto") ? "/usr/sbin/mosquitto" : "mosquitto";
    process_ = std::make_unique<Process>(std::vector<std::string>{program, "-c", (folder_ / "mosquitto.conf").string()},
                                         folder_ / "mosquitto.out", folder_ / "mosquitto.err");
    const bool up = process_->started() && wait_for([this] { return !process_->running() || listens(port_); }) &&
                    process_->running();
    if (!up) process_.reset();
  }
  void stop() { process_.reset(); }
  [[nodiscard]] int port() const { return port_; }

 private:
  std::filesystem::path folder_;
  std::string more_;
  int port_ = 0;
  std::unique_ptr<Process> process_;
};

}  // namespace robomill::test
