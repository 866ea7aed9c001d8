#pragma once
#include <memory>
#include <string>

#include "robomill/live/health/metrics.hpp"

namespace robomill::app {

/// Answers GET /metrics, of up to 32 connections at a time and once each. One that asks nothing is closed after a
/// second; one that asks for another host (serve::is_own_host) is rejected.
class MetricsServer {
 public:
  /// @param host  address to listen at; loopback unless others are to see it
  /// @param port  0: any that is free
  /// @throws InvalidInput if it cannot listen there
  MetricsServer(const live::MetricValues& values, const std::string& host, int port);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;
  [[nodiscard]] int port() const { return port_; }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  int port_ = 0;
};

}  // namespace robomill::app
