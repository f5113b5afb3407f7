// Converts files of other programs to a configuration. Pure: bytes in, texts out. Validates the
// output with the loader of `--check`; rejected points are reported.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/import/formats/format.hpp"
#include "tools/import/points/model.hpp"
#include "tools/import/points/writer.hpp"

namespace fieldcast::importing {

struct ImportOptions {
  std::string from;  // name of a format; empty: automatic
  std::string bridge = "bridge-1";
  std::string bus;                       // name of an unnamed bus; empty: "bus-1"
  std::string device;                    // name of the device, if there is only one
  std::string protocol;                  // empty: from the lists or the port
  Port port;                             // overrides the lists
  std::optional<std::uint32_t> address;  // of the first device without an address
  std::optional<Duration> refresh;       // of all channels
  std::optional<WordOrder> word_order;
  std::optional<unsigned> base;  // number of the first register, 0 or 1; empty: guessed
  bool as_template = false;
  bool lists = false;                // channel lists in separate files
  std::string file = "bridge.yaml";  // name of the configuration, or of the single template
};

struct InputFile {
  std::string file;  // path as given
  std::string bytes;
};

enum class Fate : std::uint8_t { kMoved, kChanged, kRefused };

struct PointFate {
  Fate fate = Fate::kMoved;
  std::string name;     // in the list
  std::string channel;  // bus/device/channel; empty if refused
  std::string at, type;
  std::string words;  // the changes, or the reason
  Origin origin;
  // value = raw * scale + offset
  double scale = 1, offset = 0;
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  Access access = Access::kReadOnly;
};

// Non-default settings: "scale 0.1, low word first, read-write".
[[nodiscard]] std::string settings_of(const PointFate& row);

struct Outcome {
  std::vector<std::string> recognised;  // one line for each file
  std::vector<WrittenFile> files;       // empty: nothing could be imported
  std::vector<PointFate> rows;
  std::vector<std::string> notes;
  [[nodiscard]] std::size_t count(Fate fate) const;
};

using Progress = std::function<void(double done)>;

[[nodiscard]] Result<Outcome> run_import(const std::vector<InputFile>& inputs,
                                         const ImportOptions& options,
                                         const Progress& progress = {});

// Validates options separately, so that their faults are not reported for a list.
// "--baud: baud 115000 is no rate of serial ports; allowed: ..". Empty if the options are valid.
[[nodiscard]] std::optional<std::string> fault_of_options(const ImportOptions& options);

}  // namespace fieldcast::importing
