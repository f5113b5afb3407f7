// Fuzzes data from DDS: any bytes as messages of our topics, read by the library, converted, and
// passed to the tables of a station. A message must be refused or have values of the IDL.
//
// Input: for each message topic(1), length(2, little-endian), then that many bytes.
#include <cstdlib>
#include <cstring>

#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/configuration_message.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/history.hpp"
#include "bridge/dds/topics/received_sample.hpp"
#include "bridge/station/bus_table.hpp"
#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace fieldcast {
namespace {

using fuzz::require;

rtps::SerializedPayload_t& payload_of(ByteView bytes) {
  constexpr std::size_t kMost = 0x10000;
  static rtps::SerializedPayload_t payload(kMost);
  std::memcpy(payload.data, bytes.data(), bytes.size());
  payload.length = static_cast<std::uint32_t>(bytes.size());
  payload.pos = 0;
  return payload;
}

// Returns the message, null if it is invalid. Computes its key as the library does.
template <class Generated>
const typename Generated::type* message_of(ByteView bytes) {
  static TopicType<Generated> type;
  static typename Generated::type message;
  message = {};
  if (!type.from_bytes(payload_of(bytes), &message)) return nullptr;
  rtps::InstanceHandle_t key;
  if (type.is_keyed()) require(type.key_of(&message, key, false));
  return &message;
}

// Reads and converts; checks results that are more than plain values.
template <class Generated>
void convert(ByteView bytes) {
  if (const auto* message = message_of<Generated>(bytes)) (void)from_idl(*message);
}

void read_sample(ByteView bytes) {
  static ReceivedSampleType type(64);
  ReceivedSample sample, key{.for_key = true};
  (void)type.from_bytes(payload_of(bytes), &key);
  (void)type.from_bytes(payload_of(bytes), &sample);
}

void read_command(ByteView bytes) {
  const auto* message = message_of<idl::CommandPubSubType>(bytes);
  if (message == nullptr) return;
  const auto command = from_idl(*message);
  if (!command) return require(!command.error().reason.empty());
  require(command->values.size() <= kMaxCommandValues);
  idl::Command again;
  (void)to_idl("bus", *command, again);
}

struct Tables {
  BusTable bus;
  PlanParts plans;
  BusTable::Handlers handlers{[](const StationChannel&) {}, [](const StationSample&) {},
                              [](const StationSample&) {}};
};

void read_plan(Tables& tables, ByteView bytes) {
  if (const auto* part = message_of<idl::ReadPlanPubSubType>(bytes))
    (void)tables.plans.on_part(*part);
}
void read_block(Tables& tables, ByteView bytes) {
  if (const auto* block = message_of<idl::SampleBlockPubSubType>(bytes))
    tables.bus.on_samples(*block, tables.handlers);
}
void read_catalogue(Tables& tables, ByteView bytes) {
  const auto* block = message_of<idl::CatalogueBlockPubSubType>(bytes);
  if (block == nullptr) return;
  if (block->first() % 3 == 1)
    tables.bus.on_catalogue_gone(block->epoch(), block->first(), tables.handlers);
  tables.bus.on_catalogue(*block, tables.handlers);
}

void read_history_request(ByteView bytes) {
  if (const auto* request = message_of<idl::HistoryRequestPubSubType>(bytes))
    (void)from_idl(*request);
}
void read_configuration_request(ByteView bytes) {
  if (const auto* part = message_of<idl::ConfigurationRequestPubSubType>(bytes))
    (void)ConfigurationParts().add(*part);
}
void read_history_block(ByteView bytes) {
  if (const auto* block = message_of<idl::HistoryBlockPubSubType>(bytes))
    (void)HistoryParts({.rows = HistoryRequest::kMostRows, .channels = {{}, {}}}).add(*block);
}

void read(Tables& tables, unsigned topic, ByteView bytes) {
  switch (topic) {
    case 0: return read_sample(bytes);
    case 1: return read_block(tables, bytes);
    case 2: return read_catalogue(tables, bytes);
    case 3: return read_command(bytes);
    case 4: return read_plan(tables, bytes);
    case 5: return convert<idl::CommandResultPubSubType>(bytes);
    case 6: return convert<idl::InterestPubSubType>(bytes);
    case 7: return convert<idl::BridgePubSubType>(bytes);
    case 8: return convert<idl::AlarmPubSubType>(bytes);
    case 9: return convert<idl::AlarmStatusPubSubType>(bytes);
    case 10: return convert<idl::AlarmActionPubSubType>(bytes);
    case 11: return convert<idl::BusStatusPubSubType>(bytes);
    case 12: return convert<idl::DeviceStatusPubSubType>(bytes);
    case 13: return convert<idl::ProgramSessionPubSubType>(bytes);
    case 14: return convert<idl::StandbyPubSubType>(bytes);
    case 15: return convert<idl::StandbyNotePubSubType>(bytes);
    case 16: return convert<idl::StandbyRequestPubSubType>(bytes);
    case 17: return convert<idl::ChannelPubSubType>(bytes);
    case 18: return read_history_request(bytes);
    case 19: return read_history_block(bytes);
    case 20: return read_configuration_request(bytes);
    case 21: return convert<idl::DeviceDescriptionPubSubType>(bytes);
    default: (void)message_of<idl::SnapshotRequestPubSubType>(bytes);
  }
}

void run_one(ByteView data) {
  constexpr unsigned kTopics = 23;
  Tables tables;
  while (data.size() > 3) {
    const std::size_t size = std::min<std::size_t>(data[1] | data[2] << 8, data.size() - 3);
    read(tables, data[0] % kTopics, data.subspan(3, size));
    data = data.subspan(3 + size);
  }
  tables.bus.replay(tables.handlers);
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
