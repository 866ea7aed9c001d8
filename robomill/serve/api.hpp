#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <variant>

#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/process/worker_process.hpp"
#include "robomill/serve/serve.hpp"

// Method: robomill/serve/README.md, "Interface"

namespace robomill::serve {

/// What stands behind the addresses below /api/. Requests were let through by a Guard.
class Api {
 public:
  /// An event for every page that is open: its name, its data.
  using Publish = std::function<void(std::string_view event, std::string_view data)>;
  /// @param open_stream  ServeOptions'
  /// @param worker       what works in processes of its own; without a command all is done in this one
  Api(const Folder& folder, OpenStream open_stream, const WorkerOptions& worker, Publish publish);
  ~Api();
  Api(const Api&) = delete;
  Api& operator=(const Api&) = delete;

  /// Largest body of this method and path [bytes], or why there is no such thing.
  [[nodiscard]] std::variant<std::uint64_t, HttpResponse> admit(const HttpRequest& request) const;
  /// Answers, at once or from another thread.
  void handle(HttpRequest request, const Reply& reply);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace robomill::serve
