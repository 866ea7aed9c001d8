#pragma once
#include <memory>

#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/serve.hpp"
#include "robomill/serve/tap/session.hpp"
#include "robomill/serve/worker.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// The tap test that is made, one at a time, and what the addresses at /api/tap answer. Used by one thread.
class TapTests {
 public:
  /// @param open_stream  none: hits come as files alone
  /// @param publish      TapSession's
  TapTests(const Folder& folder, OpenStream open_stream, TapSession::Publish publish);
  /// Ends it.
  ~TapTests();
  TapTests(const TapTests&) = delete;
  TapTests& operator=(const TapTests&) = delete;

  /// Of GET, POST, PUT and DELETE /api/tap, GET and PUT /api/tap/N, POST /api/tap/save.
  /// @throws InvalidInput if something asked for cannot be, io::Json::exception if the body is none
  [[nodiscard]] HttpResponse answer(const HttpRequest& request);

 private:
  [[nodiscard]] HttpResponse start(const io::Json& body);
  [[nodiscard]] HttpResponse save(const io::Json& body);
  [[nodiscard]] HttpResponse about_hit(const HttpRequest& request);
  [[nodiscard]] HttpResponse state() const;
  void end(std::shared_ptr<TapSession> test);

  const Folder& folder_;
  OpenStream open_stream_;
  TapSession::Publish publish_;
  int last_ = 0;
  std::shared_ptr<TapSession> test_;
  Worker endings_{8};  ///< a broker may take seconds to let a test go, and nobody is to wait for that
};

}  // namespace robomill::serve
