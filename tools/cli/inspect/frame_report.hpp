// Explains frames of a capture or trace; with a configuration, also the values. Main thread.
#pragma once

#include <functional>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/capture/capture_record.hpp"
#include "core/capture/pcapng_reader.hpp"
#include "core/model/spec.hpp"
#include "tools/cli/inspect/value_decoder.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct SeenFrame {
  std::string time, bus;  // human-readable; empty: unknown
  std::optional<Direction> direction;
  std::string protocol;  // empty: from the configuration, or the default
  Bytes bytes;
  std::string comment;
};

class FrameReport {
 public:
  struct Options {
    bool json = false;
    bool fields = false;                    // every field of each frame; else only faults
    std::optional<NamedProtocol> protocol;  // for frames without a protocol
    const BridgeSpec* spec = nullptr;       // null: no values
  };
  FrameReport(Options options, std::ostream& out, const Screen& screen);

  // Frames that a device sends by itself are shown when they are whole: a capture has the pieces
  // that were received.
  void show(const SeenFrame& frame);
  // Shows what has not become a whole frame. No frame may follow.
  void finish();
  void remark(const std::string& time, const std::string& bus, const std::string& text);

  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t faulty() const { return faulty_; }
  [[nodiscard]] std::size_t unknown() const { return unknown_; }  // frames of unknown protocols

 private:
  struct Explained {
    std::string protocol;
    std::vector<FrameField> fields;
  };
  struct FoundProtocol {
    std::string name;
    const ProtocolEntry* built_in = nullptr;
    const declared::Declaration* declaration = nullptr;  // both null: unknown
  };
  [[nodiscard]] ValueDecoder* decoder_of(const std::string& bus);
  [[nodiscard]] const NamedProtocol* named_protocol_of(const std::string& name);
  [[nodiscard]] FoundProtocol protocol_of(const SeenFrame& frame);
  [[nodiscard]] Explained explain(const SeenFrame& frame);
  void show_whole(const SeenFrame& frame);
  void show_lines(const SeenFrame& frame, const Explained& explained,
                  const std::vector<DecodedValue>& values);
  void show_json(const SeenFrame& frame, const Explained& explained,
                 const std::vector<DecodedValue>& values);

  const Options options_;
  std::ostream& out_;
  const Screen screen_;
  std::map<std::string, std::unique_ptr<ValueDecoder>, std::less<>> decoders_;  // by bus
  std::map<std::string, std::optional<NamedProtocol>> protocols_;               // of frames
  std::map<std::string, SeenFrame> begun_;  // by bus: the pieces of an unsolicited frame
  std::size_t frames_ = 0, faulty_ = 0, unknown_ = 0;
};

// True for pcapng, and for pcap, which is refused later. Consumes nothing. Main thread.
[[nodiscard]] bool is_capture(std::istream& in);

// "x.pcapng": such a word is never a protocol.
[[nodiscard]] bool has_name_of_capture(std::string_view path);

using OnFrame = std::function<void(const SeenFrame&)>;
using OnRemark =
    std::function<void(const std::string& time, const std::string& bus, const std::string& text)>;

struct CaptureEnd {
  std::optional<pcapng::Fault> fault;  // the frames before it are valid
  std::uint64_t offset = 0;            // of the fault
  std::uint64_t dropped = 0;
  std::size_t others = 0;  // packets that are not from a bus
  [[nodiscard]] bool is_no_capture() const {
    return fault == pcapng::Fault::kNoCapture || fault == pcapng::Fault::kOldFormat;
  }
};
[[nodiscard]] CaptureEnd read_capture(std::istream& in, const OnFrame& on_frame);
// REQUIRES: the capture has a fault. `frames`: how many precede it.
void explain_fault(const CaptureEnd& end, const std::string& name, std::size_t frames,
                   std::ostream& err);
// False if no line is a line of the trace.
[[nodiscard]] bool read_trace(std::string_view text, const OnFrame& on_frame,
                              const OnRemark& on_remark);

// Prints a read fault to `err` after the frames before it. Returns kFound for an invalid frame or a
// truncated capture, kUsage if it is not a capture.
[[nodiscard]] ExitCode show_capture(std::istream& in, const std::string& name, FrameReport& report,
                                    std::ostream& err);

[[nodiscard]] bool show_trace(std::string_view text, FrameReport& report);

}  // namespace fieldcast::cli
