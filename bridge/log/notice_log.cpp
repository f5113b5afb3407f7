#include "bridge/log/notice_log.hpp"

#include <fmt/format.h>

#include <utility>

namespace fieldcast {
namespace {

// Empty for a notice that is no fault.
std::string_view name_of(Notice::Kind kind) {
  switch (kind) {
    case Notice::Kind::kDeviceLost: return "device lost";
    case Notice::Kind::kDeviceErrors: return "errors";
    case Notice::Kind::kAddressRefused: return "address refused";
    case Notice::Kind::kOverload: return "overload";
    case Notice::Kind::kGarbage: return "garbage";
    case Notice::Kind::kForeignMaster: return "foreign master";
    case Notice::Kind::kDeviceBack:
    case Notice::Kind::kOverloadEnded:
    case Notice::Kind::kEchoFound:
    case Notice::Kind::kGarbageEnded:
    case Notice::Kind::kForeignMasterEnded: break;
  }
  return {};
}

// The fault that the notice ends, or the kind itself.
Notice::Kind fault_of(Notice::Kind kind) {
  switch (kind) {
    case Notice::Kind::kDeviceBack: return Notice::Kind::kDeviceLost;
    case Notice::Kind::kOverloadEnded: return Notice::Kind::kOverload;
    case Notice::Kind::kGarbageEnded: return Notice::Kind::kGarbage;
    case Notice::Kind::kForeignMasterEnded: return Notice::Kind::kForeignMaster;
    default: return kind;
  }
}

}  // namespace

void NoticeLog::notice(const Notice& notice, Instant now) {
  const std::string subject = notice.device.empty() ? bus_ : bus_ + "/" + notice.device;
  const Notice::Kind kind = fault_of(notice.kind);
  if (name_of(kind).empty()) return log_info(subject, notice.text);
  std::string key = fmt::format("{}/{}", notice.device, name_of(kind));
  if (kind != notice.kind) return over(key, subject, notice.text);
  // A different cause or address is a different fault.
  if (kind == Notice::Kind::kDeviceErrors) key += fmt::format("/{}", to_name(notice.cause));
  if (kind == Notice::Kind::kAddressRefused) key += "/" + notice.text;
  fault(key, subject, notice.text, now);
}

void NoticeLog::port_opened() {
  if (port_was_closed_) {
    over("port", bus_, "the port is open");
  } else {
    log_info(bus_, "the port is open");
  }
  port_was_closed_ = false;
}

void NoticeLog::port_closed(const std::string& reason, Instant now) {
  port_was_closed_ = true;
  // Another reason is news.
  if (std::exchange(port_reason_, reason) != reason) (void)filter_.recovered("port");
  fault("port", bus_, "the port is closed: " + reason, now);
}

void NoticeLog::tick(Instant now) {
  for (const auto& summary : filter_.summaries(now)) {
    log_warning(bus_, fmt::format("{}: {} more times", summary.key, summary.suppressed));
  }
}

void NoticeLog::fault(const std::string& key, const std::string& subject, const std::string& text,
                      Instant now) {
  const auto verdict = filter_.occurred(key, now);
  if (!verdict.log) return;
  log_warning(subject, verdict.suppressed == 0 ? text
                                               : fmt::format("{} ({} times since the last line)",
                                                             text, verdict.suppressed + 1));
}

void NoticeLog::over(const std::string& key, const std::string& subject, const std::string& text) {
  const auto verdict = filter_.recovered(key);
  log_info(subject, verdict.suppressed == 0
                        ? text
                        : fmt::format("{} (after {} times)", text, verdict.suppressed + 1));
}

}  // namespace fieldcast
