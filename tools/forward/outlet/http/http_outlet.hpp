// The outlet for an engine that receives data by HTTP: the records of a turn are the body of one
// request. If the server refuses it, each record is sent in a request of its own, to find those
// that it refuses. A wrong service refuses everything: a record is refused only if the server
// accepts another record in the same turn, or a body without data. After a failure, the files of
// the login are read again. Has no threads.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/forward/outlet/http/http_client.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

// What distinguishes an engine. The bodies of several records are joined by concatenation.
struct HttpEngine {
  const char* subject = "";  // in the log
  std::string path;          // of a request that writes, after the server
  std::vector<std::string> headers;
  std::string token_scheme = "Bearer";
  // Empty if the record cannot be decoded. An empty text: the engine has no place for it.
  std::function<std::optional<std::string>(const Record& record)> encode;
  std::function<std::string(const std::string& body)> compress;
  // Path of a request that creates what is missing; sent once for each connection. Empty: none.
  std::string create_path;
  // Part of the reason of a server of this engine that refuses a body without data. Empty: none
  // does.
  std::string empty_refusal;
  // Part of the reason of a server of this engine that refuses data with a status that others use
  // for a failure. Empty: none does.
  std::string refusal;
};

class HttpOutlet final : public Outlet {
 public:
  HttpOutlet(const HttpSpec& spec, HttpEngine engine, std::function<void()> wake);

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] std::optional<std::size_t> send(const Record& record) override;
  void flush() override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  static constexpr std::size_t kMostBytes = 4u << 20;          // of one body, before compression
  static constexpr Duration kPause = std::chrono::seconds{2};  // after a failure

  struct Pending {
    std::uint64_t record = 0;
    std::string name;  // "line/press"
    std::string body;
    std::string refusal;  // the server's reason; empty: not refused
  };
  enum class Written : std::uint8_t { kYes, kRefused, kFailed };

  // Returns false, and logs why, if the server cannot be used.
  [[nodiscard]] bool open();
  // Sends the request of `create_path`. Sets `reason_` if it returns false.
  [[nodiscard]] bool create();
  // Sets `reason_` unless it returns kYes.
  [[nodiscard]] Written write(const std::string& body);
  // Writes a body without data, which tests the connection, the login and the service. As write().
  [[nodiscard]] Written test();
  void write_each();
  // Removes the records if the server is the right one; otherwise they are sent again.
  void refuse(std::span<const Pending> records, bool is_right_server);
  void fail(std::span<const Pending> records);

  const HttpSpec spec_;
  const HttpEngine engine_;
  const std::function<void()> wake_;
  HttpClient client_;
  bool is_open_ = false;
  std::string reason_;
  Instant now_{};  // of this turn
  Instant next_attempt_{};
  std::vector<Pending> pending_;
  std::size_t pending_bytes_ = 0;
  std::vector<OutletResult> results_;
};

}  // namespace fieldcast::forward
