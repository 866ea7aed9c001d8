// Sends a recording (two channels of float32 at 10,240 Hz) to an MQTT broker as an accelerometer's gateway would: at
// the pace at which it was recorded, in blocks of 25 ms. publish_recording FILE HOST PORT TOPIC [RPM]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <string>
#include <thread>

#include "app/monitor/mqtt.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/stream_block.hpp"

namespace {

using robomill::InvalidInput;

constexpr double rate_hz = 10240.0, block_s = 0.025;
constexpr int channels = 2;
constexpr std::chrono::seconds patience{20};

void publish(const std::string& file, const robomill::monitor::MqttSettings& settings, double rpm) {
  const auto source = robomill::io::open_samples(file, {.channels = {"1", "2"}}, robomill::io::RawFormat::float32);
  robomill::app::MqttClient client(settings, {}, {});
  client.start();
  if (!client.wait_until_connected(patience)) throw InvalidInput(settings.host, "answers nobody");

  robomill::monitor::StreamBlock block;
  block.sample_rate_hz = rate_hz;
  block.channels = channels;
  if (rpm > 0.0) block.spindle_speed_rad_per_s = rpm * robomill::units::rpm;
  const auto frames = static_cast<std::size_t>(std::lround(block_s * block.sample_rate_hz));
  const auto begin = std::chrono::steady_clock::now();
  robomill::io::SampleBlock samples;
  std::size_t sent = 0;
  while (source->next(frames, samples)) {
    block.samples = samples.samples;
    sent += block.frames();
    // When the last of its samples was taken.
    std::this_thread::sleep_until(begin +
                                  std::chrono::duration<double>(static_cast<double>(sent) / block.sample_rate_hz));
    client.publish(settings.topic, robomill::monitor::encode_stream_block(block));
    ++block.sequence;  // also of a block that could not be sent: the monitor is to notice
  }
  client.flush(patience);
  fmt::print("{} blocks, {:.3f} s sent\n", block.sequence, static_cast<double>(sent) / block.sample_rate_hz);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fputs("usage: publish_recording FILE HOST PORT TOPIC [RPM]\n", stderr);
    return 2;
  }
  try {
    robomill::monitor::MqttSettings settings;
    settings.host = argv[2];
    settings.port = std::atoi(argv[3]);
    settings.topic = argv[4];
    publish(argv[1], settings, argc > 5 ? std::atof(argv[5]) : 0.0);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "publish_recording: %s\n", error.what());
    return 1;
  }
}
