// Where `fieldcast inspect` gets frames from: a capture, or the lines of a trace. Main thread.
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "tools/cli/exit_code.hpp"
#include "tools/cli/inspect/frame_report.hpp"

namespace fieldcast::cli {

// The bytes that follow begin a capture: pcapng, or pcap, which is refused with a word. Nothing is
// taken.
[[nodiscard]] bool is_capture(std::istream& in);

// "x.pcapng": what is in it is no protocol, whatever it is.
[[nodiscard]] bool has_name_of_capture(std::string_view path);

// Shows every frame. What ends it before its end goes to `err`; what came before is shown.
// kFound: a frame has a fault, or the capture is cut. kUsage: it is no capture at all.
[[nodiscard]] ExitCode show_capture(std::istream& in, const std::string& name, FrameReport& report,
                                    std::ostream& err);

// False: no text line is one of a trace, and nothing was shown.
[[nodiscard]] bool show_trace(std::string_view text, FrameReport& report);

}  // namespace fieldcast::cli
