#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "config/loader/loader.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/overload.hpp"
#include "tools/import/arrange.hpp"

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxRounds = 30;  // of writing and validating; each reports up to 1000 faults
constexpr unsigned kMaxStretch = 1024;
// devices of one bus in the validating configuration
constexpr std::size_t kTemplatesOfABus = 200;
constexpr Duration kDefaultRefresh = std::chrono::seconds{1};

struct Checked {
  std::vector<config::Fault> faults;
  std::optional<BridgeSpec> spec;
};

Checked check(const std::vector<WrittenFile>& files, const std::string& main_file,
              const std::string& main_text, bool refuse_hopeless) {
  config::FileReader reader;
  reader.read = [&](const std::string& path) -> tl::expected<std::string, config::FileError> {
    const auto file = std::ranges::find(files, path, &WrittenFile::name);
    if (file == files.end()) return tl::unexpected(config::FileError::kMissing);
    return file->text;
  };
  config::LoadOptions options;
  options.refuse_hopeless = refuse_hopeless;
  auto loaded = config::load_text(main_text, main_file, reader, options);
  if (!loaded) return {std::move(loaded.error()), std::nullopt};
  return {{}, std::move(*loaded)};
}

class Acceptance {
 public:
  Acceptance(Found& found, const ImportOptions& options, const std::string& head,
             const Progress& progress)
      : found_(found), options_(options), head_(head), progress_(progress) {}

  Result<std::vector<WrittenFile>> run() {
    for (unsigned round = 0; round < kMaxRounds; ++round) {
      if (found_.buses.empty()) return std::vector<WrittenFile>{};
      tell(round, 0.1);
      std::vector<WrittenFile> files = write();
      tell(round, 0.4);
      const Checked result = checked(files, false);
      if (result.faults.empty()) return stretched(std::move(files));
      if (!take_out(files, result.faults))
        return tl::unexpected(config::to_text(result.faults.front()));
    }
    return refused(
        "more than {} values that the check refuses; is it another kind of list? --from says it",
        kMaxRounds * 1000);
  }

 private:
  // Most lists are valid in the first round, so each round gets half of the remaining progress.
  void tell(unsigned round, double part) const {
    if (progress_) progress_(1 - std::pow(0.5, round) * (1 - 0.5 * part));
  }

  [[nodiscard]] Checked checked(const std::vector<WrittenFile>& files, bool refuse_hopeless) const {
    const std::string main_file = options_.as_template ? "check.yaml" : files.front().name;
    return check(files, main_file, main_text(files), refuse_hopeless);
  }

  std::vector<WrittenFile> write() const {
    if (!options_.as_template)
      return write_configuration(found_.buses, {.head = head_,
                                                .bridge = options_.bridge,
                                                .file = options_.file,
                                                .lists = options_.lists});
    std::vector<WrittenFile> files;
    for (std::size_t i = 0; i < found_.buses.size(); ++i) {
      for (std::size_t k = 0; k < found_.buses[i].devices.size(); ++k) {
        WrittenFile file = write_template(found_.buses[i].devices[k], head_);
        file.name = fmt::format("devices/{}.yaml", found_.buses[i].devices[k].name);
        for (WrittenPart& part : file.parts) part.bus = i, part.device = k;
        files.push_back(std::move(file));
      }
    }
    return files;
  }

  // Wraps templates in a configuration. REQUIRES: one bus, as arrange() makes for templates.
  [[nodiscard]] std::string main_text(const std::vector<WrittenFile>& files) const {
    if (!options_.as_template) return files.front().text;
    std::string text = "bridge: check\nbuses:\n";
    const auto& devices = found_.buses.front().devices;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (i % kTemplatesOfABus == 0)
        text += fmt::format(
            "  - name: check-{}\n    port: {{ tcp: 127.0.0.1:502 }}\n    protocol: modbus-tcp\n"
            "    devices:\n",
            i / kTemplatesOfABus);
      text += fmt::format("      - {{ name: d{0}, address: {0}, template: {1} }}\n",
                          i % kTemplatesOfABus, yaml_text(devices[i].name));
    }
    return text;
  }

  bool take_out(const std::vector<WrittenFile>& files, const std::vector<config::Fault>& faults) {
    // The first fault of each; a bus comes after its devices, a device after its points.
    std::map<std::tuple<std::size_t, std::size_t, std::size_t>, std::string> bad;
    for (const config::Fault& fault : faults) {
      for (const WrittenFile& file : files) {
        const auto part = std::ranges::lower_bound(file.parts, fault.line, {}, &WrittenPart::last);
        if (fault.file == file.name && part != file.parts.end() && part->first <= fault.line)
          bad.try_emplace({part->bus, part->device, part->point}, reason_of(fault));
      }
    }
    // From the end, so that indexes stay valid.
    for (auto at = bad.rbegin(); at != bad.rend(); ++at) {
      const auto& [place, reason] = *at;
      const auto [bus, device, index] = place;
      if (index == WrittenPart::kNone) continue;
      auto& points = found_.buses[bus].devices[device].points;
      found_.refuse(points[index].listed, points[index].origin, reason);
      points.erase(points.begin() + static_cast<std::ptrdiff_t>(index));
    }
    for (const auto& [place, reason] : bad) {
      const auto [index, device_index, point] = place;
      if (point != WrittenPart::kNone) continue;
      Bus& bus = found_.buses[index];
      if (device_index != WrittenPart::kNone) {
        Device& device = bus.devices[device_index];
        refuse_device(device, "its device", device.origin, reason, found_.refusals);
        continue;
      }
      for (Device& device : bus.devices)
        refuse_device(device, "its bus", bus.origin, reason, found_.refusals);
    }
    drop_empty(found_);
    return !bad.empty();
  }

  void stretch(unsigned factor) {
    for (Bus& bus : found_.buses) {
      for (Device& device : bus.devices) {
        for (Point& point : device.points)
          point.refresh = point.refresh.value_or(kDefaultRefresh) * factor;
      }
    }
  }

  Result<std::vector<WrittenFile>> stretched(std::vector<WrittenFile> files) {
    tell(0, 0.8);
    Checked result = checked(files, true);
    unsigned factor = 1;
    while (!result.spec && factor < kMaxStretch) {
      stretch(4);
      factor *= 4;
      files = write();
      result = checked(files, true);
    }
    if (!result.spec) return tl::unexpected(config::to_text(result.faults.front()));
    if (factor > 1)
      found_.note(
          "the line is far too slow for the refreshes of the list: all are {} times as long; say "
          "--refresh for one of your own",
          factor);
    if (options_.as_template) return files;
    for (const BusSpec& bus : result.spec->buses) {
      if (const auto overload = overload_of(bus, kAssumedResponseTime))
        found_.note("{}: {}", bus.name, to_text(*overload));
    }
    return files;
  }

  Found& found_;
  const ImportOptions& options_;
  const std::string& head_;
  const Progress& progress_;
};

}  // namespace

Result<std::vector<WrittenFile>> write_accepted(Found& found, const ImportOptions& options,
                                                const std::string& head, const Progress& progress) {
  return Acceptance(found, options, head, progress).run();
}

}  // namespace fieldcast::importing
