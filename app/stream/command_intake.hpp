#pragma once
#include <chrono>
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <string_view>

#include "commands.hpp"
#include "robomill/io/system/descriptor.hpp"

namespace robomill::app {

/// Commands in lines from standard input and from whoever connects to a socket; each gets its answer in a line. One
/// thread; input of a sender is bounded, and who does not read its answers is disconnected.
class CommandIntake {
 public:
  static constexpr std::size_t most_clients = 8;
  /// A line without its end, or nothing where it was too long -> the answer, a line without its end; empty: none.
  using Answer = std::function<std::string(std::optional<std::string_view> line)>;

  struct Options {
    int input = -1;           ///< a descriptor whose lines are commands; -1: none
    std::string listen = {};  ///< PORT on loopback, HOST:PORT, or a path (with a slash) of a UNIX socket; empty: none
  };
  /// @param answer  is called by poll()
  /// @param print   takes the answers to `input`
  /// @throws InvalidInput if it cannot listen there
  CommandIntake(const Options& options, Answer answer, std::function<void(const std::string&)> print);
  /// Removes the path of a UNIX socket.
  ~CommandIntake();
  CommandIntake(const CommandIntake&) = delete;
  CommandIntake& operator=(const CommandIntake&) = delete;

  /// Waits for input so long, and takes what there is.
  void poll(std::chrono::milliseconds time);
  /// "127.0.0.1:5005", a path; empty: it does not listen.
  [[nodiscard]] const std::string& address() const { return address_; }
  /// Whether other machines reach it.
  [[nodiscard]] bool is_public() const { return public_; }

 private:
  struct Client {
    io::Descriptor socket;
    CommandLines lines = {};
  };
  void listen_at(const std::string& place);
  void listen_at_path(const std::string& path);
  void accept_client();
  [[nodiscard]] bool serve(Client& client);
  void read_input();

  int input_;
  Answer answer_;
  std::function<void(const std::string&)> print_;
  CommandLines input_lines_ = {};
  io::Descriptor listener_ = {};
  std::string address_ = {}, path_ = {};
  bool public_ = false;
  std::list<Client> clients_ = {};
};

}  // namespace robomill::app
