// The way from the files of other programs to the files of a configuration: recognise, read, name,
// write, check. Pure: bytes in, texts out; the command line reads and writes the files.
//
// What is written was accepted by the loader that `--check` uses, in the same run: what it refuses
// is taken out and told as not moved.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "tools/import/format.hpp"
#include "tools/import/model.hpp"
#include "tools/import/writer.hpp"

namespace fieldcast::importing {

struct ImportOptions {
  std::string from;  // a format's name; empty: recognised
  std::string bridge = "bridge-1";
  std::string bus;                       // the name of a bus that has none; empty: "bus-1"
  std::string device;                    // the name of the device, where there is one alone
  std::string protocol;                  // empty: as the lists or the port say
  Port port;                             // instead of what the lists say
  std::optional<std::uint32_t> address;  // of the first device that has none
  std::optional<Duration> refresh;       // of all channels
  std::optional<WordOrder> word_order;
  std::optional<unsigned> base;  // 0 or 1, the number of the first register; empty: guessed
  bool as_template = false;
  bool lists = false;                // channels in lists beside the configuration
  std::string file = "bridge.yaml";  // the configuration, or with as_template the one template
};

struct InputFile {
  std::string file;  // its path as given
  std::string bytes;
};

enum class Fate : std::uint8_t { kMoved, kChanged, kRefused };

// What became of one value of a list.
struct PointFate {
  Fate fate = Fate::kMoved;
  std::string name;     // in the list
  std::string channel;  // bus/device/channel; empty where it is refused
  std::string at, type;
  std::string words;  // the changes, or the reason
  Origin origin;
  // What the channel makes of the registers: value = raw * scale + offset.
  double scale = 1, offset = 0;
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  Access access = Access::kReadOnly;
};

// What of these is not the default: "scale 0.1, low word first, read-write".
[[nodiscard]] std::string settings_of(const PointFate& row);

struct Outcome {
  std::vector<std::string> recognised;  // one line for each file
  std::vector<WrittenFile> files;       // empty: nothing could be moved
  std::vector<PointFate> rows;
  std::vector<std::string> notes;
  [[nodiscard]] std::size_t count(Fate fate) const;
};

// Called between the steps with how much is done, 0 to 1.
using Progress = std::function<void(double done)>;

// The error is one line: nothing of the files can be read.
[[nodiscard]] tl::expected<Outcome, std::string> run_import(const std::vector<InputFile>& inputs,
                                                            const ImportOptions& options,
                                                            const Progress& progress = {});

}  // namespace fieldcast::importing
