#include "tools/forward/outlet/http/http_outlet.hpp"

#include <fmt/format.h>

#include <utility>

#include "bridge/log/log.hpp"
#include "tools/forward/outlet/undecodable.hpp"

namespace fieldcast::forward {

namespace {

bool is_success(long status) { return status >= 200 && status < 300; }

// Responses to a body that a repetition does not change.
bool is_refusal(long status) {
  constexpr long kBadRequest = 400, kTooLarge = 413, kUnprocessable = 422;
  return status == kBadRequest || status == kTooLarge || status == kUnprocessable;
}

// False without a known part.
bool says(const std::string& reason, const std::string& part) {
  return !part.empty() && reason.find(part) != std::string::npos;
}

std::string described(const HttpResponse& response) {
  constexpr long kUnauthorized = 401, kForbidden = 403;
  const bool is_login = response.status == kUnauthorized || response.status == kForbidden;
  return fmt::format("{}status {}{}{}", is_login ? "login refused: " : "", response.status,
                     response.text.empty() ? "" : ": ", response.text);
}

}  // namespace

HttpOutlet::HttpOutlet(const HttpSpec& spec, HttpEngine engine, std::function<void()> wake)
    : spec_(spec),
      engine_(std::move(engine)),
      wake_(std::move(wake)),
      client_(spec, engine_.token_scheme) {}

bool HttpOutlet::is_ready(Instant now) {
  now_ = now;
  if (now < next_attempt_) return false;
  if (!is_open_) is_open_ = open();
  if (!is_open_) next_attempt_ = now + kPause;
  return is_open_;
}

bool HttpOutlet::create() {
  if (engine_.create_path.empty()) return true;
  const auto created = client_.post(engine_.create_path, {}, {});
  if (created && is_success(created->status)) return true;
  reason_ = created ? described(*created) : created.error();
  return false;
}

bool HttpOutlet::open() {
  const auto opened = client_.open();
  if (!opened) reason_ = opened.error();
  const Written tested = opened && create() ? test() : Written::kFailed;
  switch (tested) {
    case Written::kYes: log_info(engine_.subject, "connected to " + spec_.server); break;
    case Written::kRefused:
      log_counted(LogLevel::kWarning, engine_.subject, "refused tests",
                  fmt::format("{} refuses a request without data: {}; check that it is the right "
                              "server",
                              spec_.server, reason_));
      break;
    case Written::kFailed:
      log_counted(
          LogLevel::kWarning, engine_.subject, "failed connections",
          fmt::format("cannot use {}: {}; the forwarder tries again", spec_.server, reason_));
      break;
  }
  return tested != Written::kFailed;
}

HttpOutlet::Written HttpOutlet::test() {
  const Written written = write({});
  const bool is_known = says(reason_, engine_.empty_refusal);
  return written == Written::kRefused && is_known ? Written::kYes : written;
}

HttpOutlet::Written HttpOutlet::write(const std::string& body) {
  const auto response = client_.post(engine_.path, engine_.headers, engine_.compress(body));
  if (!response) {
    reason_ = response.error();
    return Written::kFailed;
  }
  if (is_success(response->status)) return Written::kYes;
  reason_ = described(*response);
  const bool is_refused = is_refusal(response->status) || says(response->text, engine_.refusal);
  return is_refused ? Written::kRefused : Written::kFailed;
}

std::optional<std::size_t> HttpOutlet::send(const Record& record) {
  if (pending_bytes_ >= kMostBytes) return std::nullopt;  // after the next flush()
  auto body = engine_.encode(record);
  if (!body || body->empty()) {
    if (!body) log_undecodable(record);
    results_.push_back({record.id, body ? Outcome::kAcknowledged : Outcome::kRefused});
    return 0;
  }
  const std::size_t size = body->size();
  pending_bytes_ += size;
  pending_.push_back({record.id, record.bus + '/' + record.device, *std::move(body), {}});
  return size;
}

void HttpOutlet::flush() {
  if (!results_.empty()) wake_();
  if (pending_.empty()) return;
  std::string body;
  body.reserve(pending_bytes_);
  for (const Pending& one : pending_) body += one.body;
  switch (write(body)) {
    case Written::kYes:
      for (const Pending& one : pending_) results_.push_back({one.record, Outcome::kAcknowledged});
      break;
    case Written::kRefused: write_each(); break;
    case Written::kFailed: fail(pending_); break;
  }
  pending_.clear();
  pending_bytes_ = 0;
  wake_();
}

void HttpOutlet::write_each() {
  std::vector<Pending> refused;
  bool has_accepted = false;
  std::size_t i = 0;
  for (; i < pending_.size(); ++i) {
    Pending& one = pending_[i];
    const Written written = write(one.body);
    if (written == Written::kFailed) break;
    if (written == Written::kYes) {
      has_accepted = true;
      results_.push_back({one.record, Outcome::kAcknowledged});
    } else {
      one.refusal = reason_;
      refused.push_back(std::move(one));
    }
  }
  const std::span rest = std::span(pending_).subspan(i);
  if (!refused.empty()) refuse(refused, has_accepted || (rest.empty() && test() == Written::kYes));
  if (!rest.empty()) fail(rest);
}

void HttpOutlet::refuse(std::span<const Pending> records, bool is_right_server) {
  if (!is_right_server) return fail(records);
  for (const Pending& one : records) {
    log_counted(LogLevel::kError, engine_.subject, "messages that the server refuses",
                fmt::format("{}: a message of {} bytes is removed: {}", one.name, one.body.size(),
                            one.refusal));
    results_.push_back({one.record, Outcome::kRefused});
  }
}

void HttpOutlet::fail(std::span<const Pending> records) {
  log_counted(LogLevel::kWarning, engine_.subject, "messages without an acknowledgement",
              fmt::format("{}: {}; they are sent again", spec_.server, reason_));
  for (const Pending& one : records) results_.push_back({one.record, Outcome::kFailed});
  is_open_ = false;
  next_attempt_ = now_ + kPause;
}

std::vector<OutletResult> HttpOutlet::take_results() { return std::exchange(results_, {}); }

}  // namespace fieldcast::forward
