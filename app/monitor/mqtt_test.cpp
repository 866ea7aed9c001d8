// The client against a real broker, mosquitto on loopback.
#include "mqtt.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>
#include <string>
#include <vector>

#include "testing/processes.hpp"
#include "testing/support.hpp"

namespace robomill::app {
namespace mqtt_test {

using std::chrono::seconds;

monitor::MqttSettings settings_of(const test::Mosquitto& broker) {
  monitor::MqttSettings settings;
  settings.port = broker.port();
  return settings;
}

/// Records the calls of a client.
class CallRecorder {
 public:
  MqttClient::Calls calls() {
    return {.message =
                [this](std::span<const std::byte> payload) {
                  const std::scoped_lock lock(mutex_);
                  messages_.emplace_back(reinterpret_cast<const char*>(payload.data()), payload.size());
                },
            .connection =
                [this](bool connected, const std::string& why) {
                  const std::scoped_lock lock(mutex_);
                  connections_ += connected ? 1 : 0;
                  why_ = why;  // empty once connected
                }};
  }
  [[nodiscard]] std::vector<std::string> messages() const {
    const std::scoped_lock lock(mutex_);
    return messages_;
  }
  [[nodiscard]] int connections() const {
    const std::scoped_lock lock(mutex_);
    return connections_;
  }
  [[nodiscard]] std::string why() const {
    const std::scoped_lock lock(mutex_);
    return why_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
  int connections_ = 0;
  std::string why_;
};

/// A subscription counts some time after the connection: sends until something comes back.
bool comes_through(MqttClient& client, const CallRecorder& received, const std::string& topic,
                   const std::string& text) {
  return test::wait_for([&] {
    client.publish(topic, text);
    const std::vector<std::string> messages = received.messages();
    return !messages.empty() && messages.back() == text;
  });
}

TEST(Mqtt, CarriesAnyBytes) {
  const test::Folder folder;
  const test::Mosquitto broker(folder.path());
  CallRecorder received;
  MqttClient client(settings_of(broker), "cell/+/ax", received.calls());
  EXPECT_FALSE(client.publish("cell/1/ax", "too early"));
  client.start();
  ASSERT_TRUE(client.wait_until_connected(seconds(60)));
  ASSERT_TRUE(comes_through(client, received, "cell/1/ax", std::string("\0\xFF bytes", 8)));
  ASSERT_TRUE(client.flush(seconds(60)));
  EXPECT_TRUE(client.publish("cell/2/other", "not subscribed"));
  EXPECT_TRUE(comes_through(client, received, "cell/7/ax", "last"));
  for (const std::string& message : received.messages()) EXPECT_NE(message, "not subscribed");
}

TEST(Mqtt, ComesBackWhenTheBrokerDoes) {
  const test::Folder folder;
  test::Mosquitto broker(folder.path());
  CallRecorder received;
  MqttClient client(settings_of(broker), "t", received.calls());
  client.start();
  ASSERT_TRUE(client.wait_until_connected(seconds(60)));
  for (int round = 0; round < 2; ++round) {
    broker.stop();
    // The report comes after the state.
    ASSERT_TRUE(test::wait_for([&] { return !client.connected() && !received.why().empty(); }));
    EXPECT_FALSE(client.publish("t", "nobody"));
    broker.start();
    ASSERT_TRUE(client.wait_until_connected(seconds(60)));
    EXPECT_TRUE(comes_through(client, received, "t", "round " + std::to_string(round)));
  }
  EXPECT_TRUE(test::wait_for([&] { return received.connections() >= 3; }));
}

TEST(Mqtt, WaitsForABrokerThatIsNotThereYet) {
  const test::Folder folder;
  test::Mosquitto broker(folder.path());
  broker.stop();
  CallRecorder received;
  MqttClient client(settings_of(broker), "t", received.calls());
  client.start();
  ASSERT_TRUE(test::wait_for([&] { return !received.why().empty(); }));
  broker.start();
  EXPECT_TRUE(client.wait_until_connected(seconds(60)));
}

TEST(Mqtt, LogsIn) {
  const test::Folder folder;
  const std::string passwords = folder.at("passwords").string();
  ASSERT_EQ(std::system(("mosquitto_passwd -c -b '" + passwords + "' anna geheim").c_str()),
            0);  // NOLINT(cert-env33-c)
  const test::Mosquitto broker(folder.path(), "allow_anonymous false\npassword_file " + passwords + "\n");
  monitor::MqttSettings settings = settings_of(broker);
  settings.user = "anna";
  settings.password_file = folder.file("password", "geheim\nsecond line\n");
  CallRecorder received;
  {
    MqttClient client(settings, "t", received.calls());
    client.start();
    ASSERT_TRUE(client.wait_until_connected(seconds(60)));
    EXPECT_TRUE(comes_through(client, received, "t", "hello"));
  }
  settings.password_file = folder.file("wrong", "falsch");
  CallRecorder failed;
  MqttClient client(settings, "t", failed.calls());
  client.start();
  ASSERT_TRUE(test::wait_for([&] { return !failed.why().empty(); }));
  EXPECT_EQ(failed.connections(), 0);
  settings.password_file = folder.at("missing");
  EXPECT_THROW(MqttClient(settings, "t", {}), InvalidInput);
}

TEST(Mqtt, SpeaksTls) {
  const test::Folder folder;
  const std::string cd = "cd '" + folder.path().string() + "' && ";
  const std::string certificate =
      "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=localhost "
      "-addext subjectAltName=IP:127.0.0.1,DNS:localhost -keyout key.pem -out cert.pem 2>log && chmod a+r key.pem";
  ASSERT_EQ(std::system((cd + certificate).c_str()), 0);  // NOLINT(cert-env33-c)
  const test::Mosquitto broker(folder.path(), "allow_anonymous true\ncertfile " + folder.at("cert.pem").string() +
                                                  "\nkeyfile " + folder.at("key.pem").string() + "\n");
  monitor::MqttSettings settings = settings_of(broker);
  settings.host = "localhost";
  settings.tls = true;
  settings.ca_file = folder.at("cert.pem");
  CallRecorder received;
  {
    MqttClient client(settings, "t", received.calls());
    client.start();
    ASSERT_TRUE(client.wait_until_connected(seconds(60))) << received.why();
    EXPECT_TRUE(comes_through(client, received, "t", "hello"));
  }
  // Signed by nobody that the system knows.
  settings.ca_file.clear();
  CallRecorder failed;
  MqttClient client(settings, "t", failed.calls());
  client.start();
  ASSERT_TRUE(test::wait_for([&] { return !failed.why().empty(); }));
  EXPECT_EQ(failed.connections(), 0);
}

}  // namespace mqtt_test
}  // namespace robomill::app
