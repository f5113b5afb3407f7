#include "bridge/log/notice_log.hpp"

#include <fmt/format.h>

namespace fieldcast {
namespace {

std::string_view name_of(Notice::Kind kind) {
  switch (kind) {
    case Notice::Kind::kDeviceLost: return "device lost";
    case Notice::Kind::kDeviceBack: return "device back";
    case Notice::Kind::kDeviceErrors: return "errors";
    case Notice::Kind::kAddressRefused: return "address refused";
    case Notice::Kind::kOverload: return "overload";
    case Notice::Kind::kOverloadEnded: return "overload ended";
    case Notice::Kind::kEchoFound: return "echo";
    case Notice::Kind::kGarbage: return "garbage";
    case Notice::Kind::kGarbageEnded: return "garbage ended";
    case Notice::Kind::kForeignMaster: return "foreign master";
    case Notice::Kind::kForeignMasterEnded: return "foreign master ended";
  }
  return "notice";
}

std::string key_of(Notice::Kind kind, const std::string& device) {
  return fmt::format("{}/{}", device, name_of(kind));
}

}  // namespace

void NoticeLog::notice(const Notice& notice, Instant now) {
  const std::string subject = subject_of(notice.device);
  switch (notice.kind) {
    case Notice::Kind::kDeviceBack:
      return over(key_of(Notice::Kind::kDeviceLost, notice.device), subject, notice.text);
    case Notice::Kind::kOverloadEnded:
      return over(key_of(Notice::Kind::kOverload, notice.device), subject, notice.text);
    case Notice::Kind::kGarbageEnded:
      return over(key_of(Notice::Kind::kGarbage, notice.device), subject, notice.text);
    case Notice::Kind::kForeignMasterEnded:
      return over(key_of(Notice::Kind::kForeignMaster, notice.device), subject, notice.text);
    case Notice::Kind::kEchoFound: return log_info(subject, notice.text);
    case Notice::Kind::kDeviceErrors:  // a different cause or address is a different fault
      return fault(LogLevel::kWarning,
                   fmt::format("{}/{}", key_of(notice.kind, notice.device), to_name(notice.cause)),
                   subject, notice.text, now);
    case Notice::Kind::kAddressRefused:
      return fault(LogLevel::kWarning,
                   fmt::format("{}/{}", key_of(notice.kind, notice.device), notice.text), subject,
                   notice.text, now);
    case Notice::Kind::kDeviceLost:
    case Notice::Kind::kGarbage:
    case Notice::Kind::kForeignMaster:
    case Notice::Kind::kOverload:
      return fault(LogLevel::kWarning, key_of(notice.kind, notice.device), subject, notice.text,
                   now);
  }
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
  fault(LogLevel::kWarning, "port", bus_, "the port is closed: " + reason, now);
}

void NoticeLog::tick(Instant now) {
  for (const auto& summary : filter_.summaries(now)) {
    log_warning(bus_, fmt::format("{}: {} more times", summary.key, summary.suppressed));
  }
}

void NoticeLog::fault(LogLevel level, const std::string& key, const std::string& subject,
                      const std::string& text, Instant now) {
  const auto verdict = filter_.occurred(key, now);
  if (!verdict.log) return;
  log_line(level, subject,
           verdict.suppressed == 0
               ? text
               : fmt::format("{} ({} times since the last line)", text, verdict.suppressed + 1));
}

void NoticeLog::over(const std::string& key, const std::string& subject, const std::string& text) {
  const auto verdict = filter_.recovered(key);
  log_info(subject, verdict.suppressed == 0
                        ? text
                        : fmt::format("{} (after {} times)", text, verdict.suppressed + 1));
}

}  // namespace fieldcast
