#include "mqtt.hpp"

#include <MQTTAsync.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"

namespace robomill::app {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds first_wait{250}, longest_wait{30'000};
constexpr int keep_alive_s = 20, connect_timeout_s = 10, disconnect_timeout_ms = 1000;
constexpr int max_on_their_way = 1000;

/// Of one process, however many clients it has.
std::string client_id(const monitor::MqttSettings& settings) {
  static std::atomic<int> counter{0};
  if (!settings.client_id.empty()) return settings.client_id;
  return fmt::format("robomill-{}-{}", ::getpid(), counter.fetch_add(1));
}

/// The first line of a file that others cannot read in a listing of processes.
std::string read_password(const std::filesystem::path& path) {
  if (path.empty()) return {};
  const std::string content = io::read_file(path, 4096);
  return std::string(io::trimmed(std::string_view(content).substr(0, content.find('\n'))));
}

void check_readable(const std::filesystem::path& path) {
  if (!path.empty()) (void)io::open_file(path);
}

}  // namespace

struct MqttClient::Parts {
  enum class State { wanted, connecting, connected, ended };

  monitor::MqttSettings settings;
  std::string subscription, password, ca, certificate, key;
  Calls calls;
  MQTTAsync handle = nullptr;
  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  State state = State::wanted;
  bool disconnected = false;
  milliseconds wait{0};
  int on_their_way = 0;
  std::jthread thread;

  ~Parts();
  void keep_connected();
  void connect();
  void retry(const std::string& why);
  void subscribe();
  void reported(bool is_connected, const std::string& why) const {
    if (calls.connection) calls.connection(is_connected, why);
  }
  void arrived() {
    const std::scoped_lock lock(mutex);
    on_their_way = std::max(0, on_their_way - 1);
    changed.notify_all();
  }
  void gone() {
    const std::scoped_lock lock(mutex);
    disconnected = true;
    changed.notify_all();
  }

  static Parts& of(void* context) { return *static_cast<Parts*>(context); }
  static void on_connected(void* context, MQTTAsync_successData* /*data*/);
  static void on_rejected(void* context, MQTTAsync_failureData* data);
  static void on_lost(void* context, char* cause);
  static int on_message(void* context, char* topic, int topic_length, MQTTAsync_message* message);
};

void MqttClient::Parts::on_connected(void* context, MQTTAsync_successData* /*data*/) {
  Parts& parts = of(context);
  {
    const std::scoped_lock lock(parts.mutex);
    if (parts.state == State::ended) return;
    parts.state = State::connected;
    parts.wait = milliseconds{0};
    parts.changed.notify_all();
  }
  parts.subscribe();
  parts.reported(true, {});
}

void MqttClient::Parts::on_rejected(void* context, MQTTAsync_failureData* data) {
  std::string why = "no answer";
  if (data != nullptr && data->message != nullptr) {
    why = data->message;
  } else if (data != nullptr) {
    // 1 to 5 are the broker's own answers, by MQTT 3.1.1.
    static constexpr const char* answers[] = {"protocol not spoken", "client's name rejected", "broker not available",
                                              "user or password rejected", "not authorised"};
    why = data->code >= 1 && data->code <= 5 ? answers[data->code - 1] : fmt::format("no connection ({})", data->code);
  }
  of(context).retry(why);
}

void MqttClient::Parts::on_lost(void* context, char* cause) {
  of(context).retry(cause != nullptr ? cause : "connection lost");
}

int MqttClient::Parts::on_message(void* context, char* topic, int /*topic_length*/, MQTTAsync_message* message) {
  const Parts& parts = of(context);
  if (parts.calls.message) {
    parts.calls.message(std::as_bytes(std::span(static_cast<const char*>(message->payload),
                                                static_cast<std::size_t>(std::max(0, message->payloadlen)))));
  }
  MQTTAsync_freeMessage(&message);
  MQTTAsync_free(topic);
  return 1;
}

void MqttClient::Parts::retry(const std::string& why) {
  {
    const std::scoped_lock lock(mutex);
    if (state == State::ended) return;
    state = State::wanted;
    on_their_way = 0;  // a clean session forgets them
    wait = wait == milliseconds{0} ? first_wait : std::min(2 * wait, longest_wait);
    changed.notify_all();
  }
  reported(false, why);
}

void MqttClient::Parts::subscribe() {
  if (subscription.empty()) return;
  MQTTAsync_responseOptions response = MQTTAsync_responseOptions_initializer;
  response.context = this;
  response.onFailure = [](void* context, MQTTAsync_failureData*) {
    of(context).reported(true, "the subscription was rejected");
  };
  if (MQTTAsync_subscribe(handle, subscription.c_str(), settings.qos, &response) != MQTTASYNC_SUCCESS) {
    reported(true, "the subscription could not be sent");
  }
}

void MqttClient::Parts::connect() {
  MQTTAsync_connectOptions options = MQTTAsync_connectOptions_initializer;
  options.keepAliveInterval = keep_alive_s;
  options.connectTimeout = connect_timeout_s;
  options.cleansession = 1;
  options.MQTTVersion = MQTTVERSION_3_1_1;
  options.context = this;
  options.onSuccess = &Parts::on_connected;
  options.onFailure = &Parts::on_rejected;
  if (!settings.user.empty()) {
    options.username = settings.user.c_str();
    options.password = password.c_str();
  }
  MQTTAsync_SSLOptions ssl = MQTTAsync_SSLOptions_initializer;
  if (settings.tls) {
    ssl.trustStore = ca.empty() ? nullptr : ca.c_str();
    ssl.keyStore = certificate.empty() ? nullptr : certificate.c_str();
    ssl.privateKey = key.empty() ? nullptr : key.c_str();
    ssl.enableServerCertAuth = 1;
    ssl.verify = 1;
    options.ssl = &ssl;
  }
  const int answer = MQTTAsync_connect(handle, &options);
  if (answer != MQTTASYNC_SUCCESS) retry(fmt::format("cannot connect ({})", answer));
}

void MqttClient::Parts::keep_connected() {
  std::unique_lock lock(mutex);
  while (state != State::ended) {
    if (state != State::wanted) {
      changed.wait(lock);
      continue;
    }
    changed.wait_for(lock, wait, [this] { return state == State::ended; });
    if (state == State::ended) return;
    state = State::connecting;
    lock.unlock();
    connect();
    lock.lock();
  }
}

MqttClient::Parts::~Parts() {
  {
    const std::scoped_lock lock(mutex);
    state = State::ended;
    changed.notify_all();
  }
  if (thread.joinable()) thread.join();
  if (handle == nullptr) return;
  MQTTAsync_disconnectOptions options = MQTTAsync_disconnectOptions_initializer;
  options.timeout = disconnect_timeout_ms;
  options.context = this;
  options.onSuccess = [](void* context, MQTTAsync_successData*) { of(context).gone(); };
  options.onFailure = [](void* context, MQTTAsync_failureData*) { of(context).gone(); };
  if (MQTTAsync_disconnect(handle, &options) == MQTTASYNC_SUCCESS) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, milliseconds{2 * disconnect_timeout_ms}, [this] { return disconnected; });
  }
  MQTTAsync_destroy(&handle);
}

MqttClient::MqttClient(const monitor::MqttSettings& settings, std::string subscription, Calls calls)
    : parts_(std::make_unique<Parts>()) {
  Parts& parts = *parts_;
  parts.settings = settings;
  parts.subscription = std::move(subscription);
  parts.calls = std::move(calls);
  for (const auto* file : {&settings.ca_file, &settings.certificate_file, &settings.key_file}) check_readable(*file);
  parts.password = read_password(settings.password_file);
  parts.ca = settings.ca_file.string();
  parts.certificate = settings.certificate_file.string();
  parts.key = settings.key_file.string();
  const std::string address =
      fmt::format("{}://{}:{}", settings.tls ? "ssl" : "tcp", settings.host, settings.port_or_default());
  MQTTAsync_createOptions options = MQTTAsync_createOptions_initializer;
  options.sendWhileDisconnected = 0;
  const int answer = MQTTAsync_createWithOptions(&parts.handle, address.c_str(), client_id(settings).c_str(),
                                                 MQTTCLIENT_PERSISTENCE_NONE, nullptr, &options);
  if (answer != MQTTASYNC_SUCCESS) {
    parts.handle = nullptr;
    throw InvalidInput("mqtt.host", fmt::format("\"{}\" is no address of a broker", address));
  }
  MQTTAsync_setCallbacks(parts.handle, &parts, &Parts::on_lost, &Parts::on_message, nullptr);
}

MqttClient::~MqttClient() = default;

void MqttClient::start() {
  parts_->thread = std::jthread([parts = parts_.get()] { parts->keep_connected(); });
}

bool MqttClient::connected() const {
  const std::scoped_lock lock(parts_->mutex);
  return parts_->state == Parts::State::connected;
}

bool MqttClient::wait_until_connected(milliseconds time) const {
  std::unique_lock lock(parts_->mutex);
  return parts_->changed.wait_for(lock, time, [this] { return parts_->state == Parts::State::connected; });
}

bool MqttClient::publish(const std::string& topic, std::string_view payload) {
  {
    const std::scoped_lock lock(parts_->mutex);
    if (parts_->state != Parts::State::connected || parts_->on_their_way >= max_on_their_way) return false;
    ++parts_->on_their_way;
  }
  MQTTAsync_responseOptions response = MQTTAsync_responseOptions_initializer;
  response.context = parts_.get();
  response.onSuccess = [](void* context, MQTTAsync_successData*) { Parts::of(context).arrived(); };
  response.onFailure = [](void* context, MQTTAsync_failureData*) { Parts::of(context).arrived(); };
  const int answer = MQTTAsync_send(parts_->handle, topic.c_str(), static_cast<int>(payload.size()), payload.data(),
                                    parts_->settings.qos, 0, &response);
  if (answer != MQTTASYNC_SUCCESS) parts_->arrived();
  return answer == MQTTASYNC_SUCCESS;
}

bool MqttClient::flush(milliseconds time) const {
  std::unique_lock lock(parts_->mutex);
  return parts_->changed.wait_for(lock, time, [this] { return parts_->on_their_way == 0; });
}

}  // namespace robomill::app
