// The state of an edge node of Sparkplug B and its messages: births, data, deaths, sequence numbers
// and aliases (Eclipse Sparkplug Specification 3.0.0, 5 and 6.4). Pure; one owner. Messages must be
// sent in the order in which they were made.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/forward/command/command_request.hpp"
#include "tools/forward/outlet/mqtt/mqtt_client.hpp"
#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/outlet/sparkplug/sparkplug_payload.hpp"
#include "tools/forward/outlet/sparkplug/sparkplug_spec.hpp"

namespace fieldcast::forward {

class EdgeNode {
 public:
  EdgeNode(const SparkplugSpec& spec, const std::string& site,
           RecordDecoder::FindCatalogue catalogue);

  // NDEATH for the next connection. bdSeq is the number of the connection modulo 256 (6.4.25).
  [[nodiscard]] MqttMessage will(std::uint64_t number, UtcTime now);
  // NDEATH of the present connection.
  [[nodiscard]] MqttMessage death(UtcTime now) const;
  // NBIRTH, and DBIRTH of all devices that are not dead.
  [[nodiscard]] std::vector<MqttMessage> births(UtcTime now);

  // DDEATH of the devices that no bridge announces any more (5.5).
  [[nodiscard]] std::vector<MqttMessage> deaths(const IsAnnounced& is_announced, UtcTime now);

  // The messages of a record; there may be none. Begins with DBIRTH if the device needs one, and
  // ends with DDEATH if no channel of the device responds. Empty if the record cannot be decoded.
  [[nodiscard]] std::optional<std::vector<MqttMessage>> messages(const Record& record, UtcTime now);

  // The writes that a host requests by DCMD, or why one is refused. `id` is the same for a repeated
  // message.
  using Write = tl::expected<CommandRequest, std::string>;
  [[nodiscard]] std::vector<Write> writes(const MqttMessage& command) const;
  // A write that has not begun so long after the time of its message is not run.
  static constexpr Duration kCommandLife = std::chrono::seconds{10};

  [[nodiscard]] std::string command_topic() const { return node_topic("NCMD"); }
  // Commands to all devices.
  [[nodiscard]] std::string device_command_topics() const { return node_topic("DCMD") + "/+"; }

 private:
  struct Last {
    Value value;
    Quality quality = Quality::kNotYetRead;
    UtcTime at;
  };
  struct Alarm {
    std::uint64_t alias = 0;  // 0: the channel has no such limit
    std::optional<bool> is_active;
    UtcTime at;
  };
  struct Channel {
    StationChannel entry;
    std::uint64_t alias = 0;
    MetricType type = MetricType::kDouble;
    std::optional<Last> last;
    bool was_good = true;         // the last sent quality
    std::array<Alarm, 4> alarms;  // by LimitKind
  };
  struct Device {
    std::string id;               // in topics
    std::uint64_t catalogue = 0;  // identity
    std::uint64_t record = 0;     // the record that named the catalogue
    std::vector<Channel> channels;
    std::unordered_map<std::string, std::size_t> index;  // by the channel's name
    bool is_born = false, is_dead = false;
    UtcTime born_at{};
    // States that arrived before the catalogue, by channel and limit; at most kMostEarly.
    std::map<std::pair<std::string, std::size_t>, AlarmStatus> early_alarms;
  };
  static constexpr std::size_t kMostEarly = 10'000;
  using Messages = std::vector<MqttMessage>;

  [[nodiscard]] std::string node_topic(std::string_view type) const;
  [[nodiscard]] MqttMessage made(std::string_view type, const Device* device,
                                 const std::vector<Metric>& metrics, UtcTime now);
  [[nodiscard]] Device& device_of(const Record& record);
  [[nodiscard]] std::uint64_t alias_of(const std::string& metric);
  void set_catalogue(Device& device, const DeviceCatalogue& catalogue, std::uint64_t identity,
                     std::uint64_t record);
  void bear(Device& device, Messages& messages, UtcTime now);
  void die(Device& device, Messages& messages, UtcTime now);
  [[nodiscard]] static bool is_silent(const Device& device);
  [[nodiscard]] Write write_of(const Device& device, const HostCommand& command,
                               const CommandMetric& metric) const;

  [[nodiscard]] std::optional<Messages> catalogue(const Record& record);
  [[nodiscard]] std::optional<Messages> samples(const Record& record, UtcTime now);
  [[nodiscard]] std::optional<Messages> alarm(const Record& record, UtcTime now);
  // The channel of each sample; null if the device has it no more. Widens types.
  [[nodiscard]] static std::vector<Channel*> channels_of(Device& device,
                                                         const RecordDecoder::Samples& samples);
  [[nodiscard]] static Metric metric_of(Channel& channel, const BatchSample& sample, bool is_late);

  const SparkplugSpec spec_;
  const std::string node_;
  RecordDecoder decoder_;
  std::map<std::pair<std::string, std::string>, Device> devices_;  // by bus and device
  // Never change while this process runs.
  std::unordered_map<std::string, std::uint64_t> aliases_;
  std::uint8_t next_seq_ = 0;
  std::uint8_t bd_seq_ = 0;
};

}  // namespace fieldcast::forward
