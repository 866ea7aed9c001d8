#pragma once
// For tests.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

namespace robomill::test {

/// The whole answer of a server on loopback; empty where there is none.
/// @param host  that is asked for; empty: localhost at the port
inline std::string http_get(int port, const std::string& path, std::string host = {}) {
  if (host.empty()) host = "localhost:" + std::to_string(port);
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) {
    const std::string request = "GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n";
    if (::send(descriptor, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size())) {
      std::array<char, 4096> bytes = {};
      for (ssize_t count = 0; (count = ::recv(descriptor, bytes.data(), bytes.size(), 0)) > 0;) {
        answer.append(bytes.data(), static_cast<std::size_t>(count));
      }
    }
  }
  ::close(descriptor);
  return answer;
}

}  // namespace robomill::test
