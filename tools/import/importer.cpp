#include "tools/import/importer.hpp"

#include <algorithm>
#include <array>

#include "config/loader/loader.hpp"
#include "core/base/value.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/import/arrange.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/points/writer.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {

namespace {

struct Group {
  const Format* format = nullptr;
  std::vector<SourceText> sources;
};

std::string format_names() {
  std::vector<std::string_view> names;
  for (const Format& format : formats()) names.push_back(format.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<std::vector<Group>> recognise_all(const std::vector<InputFile>& inputs,
                                         const ImportOptions& options, Outcome& outcome) {
  std::vector<Group> groups;
  for (const InputFile& input : inputs) {
    if (trimmed(input.bytes).empty()) return refused("{}: the file is empty", input.file);
    auto decoded = is_xlsx(input.bytes) ? table_of_xlsx(input.bytes) : decode_text(input.bytes);
    if (!decoded) return refused("{}: {}", input.file, decoded.error());
    SourceText source{input.file, std::move(decoded->text)};
    Recognised recognised{format_by_name(options.from), kCertain};
    if (recognised.format == nullptr) recognised = recognise(source);
    if (recognised.format == nullptr)
      return refused("{}: of no format that is known here; --from says it: {}", input.file,
                     format_names());
    outcome.recognised.push_back(fmt::format(
        "{}: {}{}, {}", input.file,
        options.from.empty() ? std::string(to_text_of(recognised.confidence)) + ' ' : "",
        recognised.format->title, decoded->encoding));
    const auto known = std::ranges::find(groups, recognised.format, &Group::format);
    Group& group =
        known == groups.end() ? groups.emplace_back(Group{recognised.format, {}}) : *known;
    group.sources.push_back(std::move(source));
  }
  return groups;
}

void append(Found& all, Found&& more) {
  std::ranges::move(more.buses, std::back_inserter(all.buses));
  std::ranges::move(more.refusals, std::back_inserter(all.refusals));
  std::ranges::move(more.notes, std::back_inserter(all.notes));
  std::ranges::move(more.guesses, std::back_inserter(all.guesses));
}

std::string head_of(const std::vector<InputFile>& inputs, bool as_template) {
  std::string files;
  for (std::size_t i = 0; i < std::min<std::size_t>(inputs.size(), 3); ++i)
    files += (i == 0 ? "" : ", ") + stem_of(inputs[i].file);
  if (inputs.size() > 3) files += fmt::format(" and {} more", inputs.size() - 3);
  for (char& c : files) c = static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return fmt::format(
      "Written by `fieldcast import` from {}.\n{}"
      "Compare the values with the device's display before you trust them.",
      files,
      as_template ? "A device uses it by `template: NAME`; put it into the folder devices/ beside "
                    "the configuration.\n"
                  : "");
}

std::size_t count_points(const Found& found) {
  std::size_t points = 0;
  for (const Bus& bus : found.buses) {
    for (const Device& device : bus.devices) points += device.points.size();
  }
  return points;
}

std::string reading_of(const Found& found, const std::string& file) {
  for (const Bus& bus : found.buses) {
    for (const Device& device : bus.devices) {
      const auto point = std::ranges::find_if(device.points, [&](const Point& one) {
        return one.origin.file == file && one.access != Access::kWriteOnly;
      });
      if (point == device.points.end()) continue;
      const Port& port = bus.port;
      const bool ordered = point->word_order == WordOrder::kLittleEndian ||
                           point->byte_order == ByteOrder::kLittleEndian;
      return fmt::format("fieldcast read {} --protocol {}{}{} --address {} {} {} {}",
                         port.tcp.empty() ? port.serial : port.tcp, bus.protocol,
                         port.line.baud ? fmt::format(" --baud {}", *port.line.baud) : "",
                         port.line.format.empty() ? "" : " --format " + port.line.format,
                         device.address.value_or(1), point->at, ordered ? "--as" : "--type",
                         type_text(*point));
    }
  }
  return {};
}

void tell_guesses(Found& found) {
  for (const BaseGuess& guess : found.guesses) {
    const std::string reading = reading_of(found, guess.file);
    if (reading.empty()) continue;
    found.note(
        "{}: the addresses are taken to count from {}: {}; compare one value with the "
        "device's display: {}; if it differs, try --base {}",
        guess.file, guess.base, guess.reason, reading, 1 - guess.base);
  }
}

void tell_moved(const Found& found, Outcome& outcome) {
  for (const Bus& bus : found.buses) {
    for (const Device& device : bus.devices) {
      for (const Point& point : device.points) {
        PointFate& row = outcome.rows.emplace_back();
        row.fate = point.changes.empty() ? Fate::kMoved : Fate::kChanged;
        row.name = point.listed;
        row.channel = fmt::format("{}/{}/{}", bus.name, device.name, point.name);
        row.at = point.at;
        row.type = type_text(point);
        row.words = fmt::format("{}", fmt::join(point.changes, "; "));
        row.origin = point.origin;
        row.scale = point.scale;
        row.offset = point.offset;
        const bool wide = is_number(point.type) && registers_of(point.type, 0) > 1;
        if (wide) row.word_order = point.word_order;
        if (point.type != ValueType::kBool && !point.byte) row.byte_order = point.byte_order;
        row.access = point.access;
      }
    }
  }
  for (const auto& [name, origin, reason] : found.refusals)
    outcome.rows.push_back({Fate::kRefused, name, {}, {}, {}, reason, origin});
  std::ranges::stable_sort(outcome.rows, {}, [](const PointFate& row) {
    return std::pair(row.origin.file, row.origin.line);
  });
}

}  // namespace

std::string settings_of(const PointFate& row) {
  std::vector<std::string> settings;
  if (row.scale != 1) settings.push_back("scale " + number_text(row.scale));
  if (row.offset != 0) settings.push_back("offset " + number_text(row.offset));
  if (row.word_order == WordOrder::kLittleEndian) settings.emplace_back("low word first");
  if (row.byte_order == ByteOrder::kLittleEndian) settings.emplace_back("low byte first");
  if (row.access != Access::kReadOnly) settings.emplace_back(to_text(row.access));
  return fmt::format("{}", fmt::join(settings, ", "));
}

std::size_t Outcome::count(Fate fate) const {
  return static_cast<std::size_t>(std::ranges::count(rows, fate, &PointFate::fate));
}

Result<Outcome> run_import(const std::vector<InputFile>& inputs, const ImportOptions& options,
                           const Progress& progress) {
  const auto tell = [&](double done) {
    if (progress) progress(done);
  };
  Outcome outcome;
  tell(0);
  if (const auto fault = fault_of_options(options); fault && !options.as_template)
    return tl::unexpected(*fault);
  auto groups = recognise_all(inputs, options, outcome);
  if (!groups) return tl::unexpected(groups.error());
  tell(0.3);
  Found found;
  const ReadOptions read_options{options.word_order, options.base, options.protocol};
  for (const Group& group : *groups) {
    if (options.base && !group.format->base.empty())
      found.note("--base is not used: addresses of {} count from {}", group.format->title,
                 group.format->base);
    auto read = group.format->read(group.sources, read_options);
    if (!read) return tl::unexpected(read.error());
    if (count_points(*read) == 0 && read->refusals.empty())
      return refused("{}: it looks like {}, and names no value", group.sources.front().file,
                     group.format->title);
    append(found, std::move(*read));
  }
  tell(0.5);
  arrange(found, options);
  if (const std::size_t points = count_points(found); points > kMaxPoints)
    return refused("{} values; a bridge has at most {} channels: split the lists", points,
                   kMaxPoints);
  auto files = write_accepted(found, options, head_of(inputs, options.as_template),
                              [&](double done) { tell(0.5 + 0.5 * done); });
  if (!files) return tl::unexpected(files.error());
  tell(1);
  tell_guesses(found);
  outcome.files = std::move(*files);
  tell_moved(found, outcome);
  outcome.notes = std::move(found.notes);
  return outcome;
}

namespace {

struct OptionLine {
  unsigned line;
  std::string_view options;
};
constexpr std::array kOptionLines{OptionLine{1, "--bridge"},
                                  OptionLine{4, "--port, --baud, --format"},
                                  OptionLine{5, "--protocol"}, OptionLine{8, "--address"}};

// Missing options get values that a list may still replace.
std::string configuration_of(const ImportOptions& options) {
  Port port = options.port;
  const bool said = !port.serial.empty() || !port.tcp.empty();
  const ProtocolEntry* entry = find_protocol(options.protocol);
  const bool no_line = !port.line.baud && port.line.format.empty();
  const bool network = entry != nullptr ? entry->network_only : options.protocol.empty() && no_line;
  if (!said) (network ? port.tcp : port.serial) = network ? "127.0.0.1:502" : "/dev/ttyUSB0";
  std::string protocol = options.protocol;
  if (protocol.empty()) protocol = port.tcp.empty() ? "modbus-rtu" : "modbus-tcp";
  if (!port.tcp.empty() && protocol == "modbus-tcp") port.line = {};  // as arrange() does
  return fmt::format(
      "bridge: {}\nbuses:\n  - name: check\n    port: {{ {} }}\n    protocol: {}\n    devices:\n"
      "      - name: check\n        address: {}\n        channels: []\n",
      yaml_text(options.bridge), port_text(port), protocol, options.address.value_or(1));
}

}  // namespace

std::optional<std::string> fault_of_options(const ImportOptions& options) {
  constexpr std::string_view kName = "options";
  config::FileReader nothing;
  nothing.read = [](const std::string&) -> tl::expected<std::string, config::FileError> {
    return tl::unexpected(config::FileError::kMissing);
  };
  const auto loaded = config::load_text(configuration_of(options), std::string(kName), nothing);
  if (loaded) return std::nullopt;
  for (const config::Fault& fault : loaded.error()) {
    const auto said = std::ranges::find(kOptionLines, fault.line, &OptionLine::line);
    if (said == kOptionLines.end()) continue;
    return fmt::format("{}: {}", said->options, reason_of(fault));
  }
  return std::nullopt;
}

}  // namespace fieldcast::importing
