#include "tools/bench/plant/bare.hpp"

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fstream>
#include <stdexcept>
#include <string>

#include "bridge/dds/library/fastdds.hpp"
#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/topic_type.hpp"

namespace fieldcast::bench {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBlocksHeld = 256;
constexpr std::size_t kBlockBytes = 32'000;  // as a bridge on the loopback

template <class Entity>
Entity* need(Entity* entity, const char* what) {
  if (entity == nullptr) throw std::runtime_error(std::string("cannot make a bare ") + what);
  return entity;
}

class Side {
 public:
  Side(unsigned domain, BareData data) : data_(data) {
    prepare_library();
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    qos.transport().use_builtin_transports = false;
    auto udp = std::make_shared<rtps_transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = {"127.0.0.1"};
    qos.transport().user_transports.push_back(udp);
    auto* const factory = dds::DomainParticipantFactory::get_instance();
    participant_ = need(factory->create_participant(domain, qos), "participant");
    const bool blocks = data == BareData::kBlocks;
    const char* const name = blocks ? "bare/Block" : "bare/Sample";
    dds::TypeSupport type(blocks ? static_cast<dds::TopicDataType*>(new idl::SampleBlockPubSubType)
                                 : new TopicType<idl::SamplePubSubType>);
    type.register_type(participant_, name);
    topic_ = need(participant_->create_topic(name, name, dds::TOPIC_QOS_DEFAULT), "topic");
  }
  ~Side() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;

  template <class Qos>
  [[nodiscard]] Qos qos(Qos qos) const {
    const bool blocks = data_ == BareData::kBlocks;
    qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind =
        blocks ? dds::VOLATILE_DURABILITY_QOS : dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().depth = blocks ? kBlocksHeld : 1;
    qos.resource_limits().max_instances = blocks ? 1 : kMaxChannels;
    qos.resource_limits().max_samples_per_instance = qos.history().depth;
    qos.resource_limits().max_samples = blocks ? kBlocksHeld : kMaxChannels;
    qos.resource_limits().allocated_samples = 0;
    qos.endpoint().history_memory_policy =
        blocks ? rtps::DYNAMIC_REUSABLE_MEMORY_MODE : rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    qos.data_sharing().off();
    return qos;
  }
  dds::DataWriter* writer() {
    auto* const publisher = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    return need(publisher->create_datawriter(topic_, qos(dds::DATAWRITER_QOS_DEFAULT)), "writer");
  }
  dds::DataReader* reader(dds::DataReaderListener* listener) {
    auto* const subscriber = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
    return need(subscriber->create_datareader(topic_, qos(dds::DATAREADER_QOS_DEFAULT), listener),
                "reader");
  }

 private:
  const BareData data_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Topic* topic_ = nullptr;
};

}  // namespace

struct BareWriter::State {
  State(unsigned domain, BareData wanted, std::size_t count)
      : side(domain, wanted), data(wanted), channels(count), writer(side.writer()) {
    block.bus() = "bare";
    sample.bus() = "bare";
    sample.device() = "unit";
    for (std::size_t i = 0; i < channels; ++i) names.push_back("channel-" + std::to_string(i));
  }

  void write_block(std::size_t rows, const LastValue& value) {
    BlockFiller filler(block, kBlockBytes);
    for (std::size_t i = 0; i < rows; ++i, next = (next + 1) % channels) {
      if (filler.add(static_cast<ChannelIndex>(next), value)) continue;
      filler.finish();
      writer->write(&block);
      filler = BlockFiller(block, kBlockBytes);
      (void)filler.add(static_cast<ChannelIndex>(next), value);  // an empty block has space
    }
    filler.finish();
    writer->write(&block);
  }
  void write_samples(std::size_t rows, const LastValue& value) {
    sample.value().uint64_value(value.bits);
    sample.quality(value.quality);
    sample.acquired_at(value.acquired_at);
    sample.sequence(value.sequence);
    for (std::size_t i = 0; i < rows; ++i, next = (next + 1) % channels) {
      sample.channel() = names[next];
      writer->write(&sample);
    }
  }

  Side side;
  const BareData data;
  const std::size_t channels;
  dds::DataWriter* const writer;
  std::vector<std::string> names;
  std::size_t next = 0;  // next channel
  idl::SampleBlock block;
  idl::Sample sample;
};

BareWriter::BareWriter(unsigned domain, BareData data, std::size_t channels)
    : state_(std::make_unique<State>(domain, data, channels)) {}
BareWriter::~BareWriter() = default;

void BareWriter::write(std::size_t rows, std::uint64_t number) {
  LastValue value;
  value.kind = idl::ValueKind::VALUE_UINT64;
  value.quality = idl::Quality::GOOD;
  value.bits = number;
  value.acquired_at = std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
  value.sequence = number;
  state_->data == BareData::kBlocks ? state_->write_block(rows, value)
                                    : state_->write_samples(rows, value);
}

struct BareReader::State : dds::DataReaderListener {
  State(unsigned domain, BareData data, std::function<void(const Row&)> handler)
      : side(domain, data), blocks(data == BareData::kBlocks), on_row(std::move(handler)) {
    reader = side.reader(this);
  }
  ~State() override { reader->set_listener(nullptr); }

  void on_data_available(dds::DataReader* from) override {
    blocks ? take_blocks(*from) : take_samples(*from);
  }
  void take_blocks(dds::DataReader& from) {
    dds::SampleInfo info;
    while (from.take_next_sample(&block, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      for (std::size_t i = 0; i < block.values().size(); ++i)
        report(block.values()[i], block.acquired_at()[0]);
    }
  }
  void take_samples(dds::DataReader& from) {
    dds::SampleInfo info;
    while (from.take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) report(sample.value().uint64_value(), sample.acquired_at());
    }
  }
  void report(std::uint64_t number, std::int64_t written) const {
    on_row({number, Clock::time_point(std::chrono::nanoseconds(written))});
  }

  Side side;
  const bool blocks;
  const std::function<void(const Row&)> on_row;
  idl::SampleBlock block;
  idl::Sample sample;
  dds::DataReader* reader = nullptr;
};

BareReader::BareReader(unsigned domain, BareData data, std::function<void(const Row&)> on_row)
    : state_(std::make_unique<State>(domain, data, std::move(on_row))) {}
BareReader::~BareReader() = default;

namespace {

const char* word(BareData data) { return data == BareData::kBlocks ? "blocks" : "samples"; }

std::uint64_t last_number(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  for (std::uint64_t next = 0; file >> next;) number = next;
  return number;
}

}  // namespace

BarePair::BarePair(const ScratchFolder& folder, unsigned domain, BareData data,
                   const BareLoad& load)
    : reader_log_(folder.path() + "/bare-reader-" + word(data) + ".log"),
      writer_log_(folder.path() + "/bare-writer-" + word(data) + ".log"),
      reader_("bench_bare", {std::to_string(domain), word(data), "read"}, reader_log_),
      writer_(
          "bench_bare",
          {std::to_string(domain), word(data), "write", std::to_string(load.channels),
           std::to_string(load.rows), std::to_string(static_cast<int>(1e6 / load.blocks_a_second))},
          writer_log_) {}

BarePair::Spent BarePair::spent() const {
  return {last_number(writer_log_), last_number(reader_log_), writer_.cpu_seconds(),
          reader_.cpu_seconds()};
}

}  // namespace fieldcast::bench
