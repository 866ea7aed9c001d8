#include "robomill/serve/guard.hpp"

#include <gtest/gtest.h>

namespace robomill::serve {
namespace guard_test {

HttpRequest request(std::string method, std::string path, std::map<std::string, std::string, std::less<>> headers) {
  return {.method = std::move(method), .path = std::move(path), .query = {}, .headers = std::move(headers)};
}
int status(const Guard& guard, const HttpRequest& asked) {
  const auto rejected = guard.reject(asked);
  return rejected ? rejected->status : 200;
}

TEST(Guard, KnowsItsOwnHostAlone) {
  Guard guard("127.0.0.1", "");
  guard.set_port(8437);
  for (const char* host : {"127.0.0.1:8437", "localhost:8437", "[::1]:8437"}) {
    EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}})), 200) << host;
  }
  // A name of an attacker that resolves to this machine has another Host.
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8437", "localhost:8437.evil.example", "127.0.0.1:8437 "}) {
    EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}})), 403) << host;
  }
}

TEST(Guard, RejectsOtherSites) {
  Guard guard("127.0.0.1", "");
  guard.set_port(8437);
  const std::string host = "localhost:8437";
  EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}, {"origin", "http://localhost:8437"}})), 200);
  for (const char* origin :
       {"null", "http://evil.example", "https://localhost:8437", "http://127.0.0.1:8437", "http://localhost:84370"}) {
    EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}, {"origin", origin}})), 403) << origin;
  }
  EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}, {"sec-fetch-site", "cross-site"}})), 403);
  EXPECT_EQ(status(guard, request("GET", "/page.js", {{"host", host}, {"sec-fetch-site", "same-site"}})), 403);
  EXPECT_EQ(status(guard, request("GET", "/", {{"host", host}, {"sec-fetch-site", "cross-site"}})), 200);  // a link
}

TEST(Guard, WritesNeedThePagesToken) {
  Guard guard("127.0.0.1", "");
  guard.set_port(1);
  const auto write = [&](const std::string& token) {
    return status(guard, request("POST", "/api/jobs", {{"host", "127.0.0.1:1"}, {"x-robomill-token", token}}));
  };
  EXPECT_EQ(write(guard.write_token()), 200);
  EXPECT_EQ(write(""), 403);
  EXPECT_EQ(write(guard.write_token() + "0"), 403);
  EXPECT_EQ(write(std::string(64, '0')), 403);
  EXPECT_EQ(guard.write_token().size(), 64u);
  EXPECT_NE(guard.write_token(), Guard("127.0.0.1", "").write_token());
}

TEST(Guard, AccessTokenByAddressCookieOrHeader) {
  const std::string token = "abcdefghijklmnop";
  Guard guard("0.0.0.0", token);
  guard.set_port(8437);
  const std::string host = "mill.local:8437";
  EXPECT_EQ(status(guard, request("GET", "/", {{"host", host}})), 401);
  EXPECT_EQ(status(guard, request("GET", "/", {{"host", host}, {"cookie", "a=b; robomill-8437=" + token}})), 200);
  // Cookies are of a host, not of a port: another server there has another name.
  EXPECT_EQ(status(guard, request("GET", "/", {{"host", host}, {"cookie", "robomill-8438=x; robomill-8437=" + token}})),
            200);
  EXPECT_EQ(status(guard, request("GET", "/", {{"host", host}, {"cookie", "robomill-8438=" + token}})), 401);
  EXPECT_EQ(status(guard, request("GET", "/", {{"host", host}, {"cookie", "robomill-8437=abcdefghijklmnoq"}})), 401);
  EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}, {"authorization", "Bearer " + token}})), 200);
  EXPECT_EQ(status(guard, request("GET", "/api/state", {{"host", host}, {"authorization", "Bearer x"}})), 401);
  HttpRequest page = request("GET", "/", {{"host", host}});
  page.query["token"] = token;
  EXPECT_EQ(status(guard, page), 200);
  ASSERT_TRUE(guard.cookie_for(page));
  EXPECT_EQ(*guard.cookie_for(page), "robomill-8437=" + token + "; HttpOnly; SameSite=Strict; Path=/");
  page.path = "/api/state";  // in the address of the page alone
  EXPECT_EQ(status(guard, page), 401);
}

TEST(Guard, KnowsWhoProvesIt) {
  const std::string host = "127.0.0.1:8437", token = "abcdefghijklmnop";
  Guard open("127.0.0.1", ""), closed("127.0.0.1", token);
  for (Guard* guard : {&open, &closed}) guard->set_port(8437);
  const auto get = [&](const char* name, const std::string& value, const std::string& to) {
    return request("GET", "/api/state", {{"host", to}, {name, value}});
  };
  // Without an access token everybody may ask; who has a page of this server is known.
  EXPECT_FALSE(open.knows(get("x", "", host)));
  EXPECT_TRUE(open.knows(get("x-robomill-token", open.write_token(), host)));
  EXPECT_FALSE(open.knows(get("x-robomill-token", open.write_token(), "evil.example:8437")));
  EXPECT_FALSE(closed.knows(get("x-robomill-token", closed.write_token(), host)));
  EXPECT_TRUE(closed.knows(get("authorization", "Bearer " + token, host)));
}

TEST(Guard, LocalhostIsAnAddress) {
  EXPECT_EQ(host_address("localhost"), "127.0.0.1");
  EXPECT_EQ(host_address("192.168.1.2"), "192.168.1.2");
  EXPECT_TRUE(is_own_host("localhost:9110", "127.0.0.1", 9110));
  EXPECT_FALSE(is_own_host("evil.example:9110", "127.0.0.1", 9110));
  EXPECT_TRUE(is_own_host("mill.local:9110", "0.0.0.0", 9110));
}

TEST(Guard, Loopback) {
  EXPECT_TRUE(is_loopback("127.0.0.1"));
  EXPECT_TRUE(is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0"));
  EXPECT_FALSE(is_loopback("192.168.1.2"));
  EXPECT_TRUE(equal_secrets("abc", "abc"));
  EXPECT_FALSE(equal_secrets("abcd", "abc"));
  EXPECT_FALSE(equal_secrets("ab", "abc"));
}

}  // namespace guard_test
}  // namespace robomill::serve
