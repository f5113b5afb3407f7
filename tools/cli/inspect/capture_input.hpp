// Reads frames for `fieldcast inspect` from a capture or from lines of a trace. Main thread.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/inspect/frame_report.hpp"

namespace fieldcast::cli {

// Returns whether the stream starts like pcapng or pcap; pcap is refused later with a message.
// Consumes nothing.
[[nodiscard]] bool is_capture(std::istream& in);

// "x.pcapng": such a word is never a protocol.
[[nodiscard]] bool has_name_of_capture(std::string_view path);

// Shows every frame. If reading fails, prints the reason to `err` after the frames before it.
// Returns kFound if a frame is invalid or the capture is truncated, kUsage if it is not a capture.
[[nodiscard]] ExitCode show_capture(std::istream& in, const std::string& name, FrameReport& report,
                                    std::ostream& err);

// Returns false if no line belongs to a trace; nothing was shown then.
[[nodiscard]] bool show_trace(std::string_view text, FrameReport& report);

}  // namespace fieldcast::cli
