// Names of NATS: subjects of the messages. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tools/forward/batch/record.hpp"

namespace fieldcast::forward {

inline constexpr std::string_view kSampleSubjects = "fieldcast";
inline constexpr std::string_view kLateSubjects = "fieldcast-late";
inline constexpr std::string_view kAlarmSubjects = "fieldcast-alarm";
inline constexpr std::string_view kAuditSubjects = "fieldcast-audit";

// One token of a subject: each byte that is not an ASCII letter, a digit, '-' or '_' becomes "=2E".
// The result is also allowed in a key of a key-value bucket. "=" for an empty name.
[[nodiscard]] std::string subject_token(std::string_view name);

// "fieldcast.SITE.BUS.DEVICE", with "fieldcast-late" for late samples and "fieldcast-alarm" for
// alarms, "fieldcast-audit.SITE.BRIDGE", or for a catalogue "$KV.BUCKET.SITE.BUS.DEVICE.IDENTITY".
[[nodiscard]] std::string subject_of(std::string_view site, std::string_view bucket,
                                     const Record& record);

// "SITE.BUS.DEVICE.IDENTITY": the key of a catalogue in its bucket.
[[nodiscard]] std::string catalogue_key_of(std::string_view site, std::string_view bus,
                                           std::string_view device, std::uint64_t identity);

// "$KV.BUCKET.SITE": the state of the site.
[[nodiscard]] std::string site_subject_of(std::string_view bucket, std::string_view site);

// "fieldcast-command.SITE.*": the last token is the user.
inline constexpr std::string_view kCommandSubjects = "fieldcast-command";
[[nodiscard]] std::string command_subject_of(std::string_view site);
[[nodiscard]] std::string command_subject_of(std::string_view site, std::string_view user);
// Returns the name for which subject_token() returns this token. Empty for any other text.
[[nodiscard]] std::string name_of_token(std::string_view token);

}  // namespace fieldcast::forward
