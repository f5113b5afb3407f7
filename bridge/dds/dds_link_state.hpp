// What a DdsLink is made of. Private to it; its functions are in two files: dds_link.cpp joins,
// adds and removes buses and leaves, dds_link_publish.cpp says what buses have to say.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

#include "bridge/dds/block_writer.hpp"
#include "bridge/dds/bridge_presence.hpp"
#include "bridge/dds/bus_catalogue.hpp"
#include "bridge/dds/dds_link.hpp"
#include "bridge/dds/interest_receiver.hpp"
#include "bridge/dds/request_receiver.hpp"
#include "bridge/dds/result_sender.hpp"
#include "bridge/dds/sample_writers.hpp"
#include "bridge/dds/snapshot_sender.hpp"

namespace fieldcast {

// What one bus has in the domain besides the writers shared by all.
struct LinkedBus {
  LinkedBus(Domain& domain, const std::string& bridge, const BusSpec& spec,
            dds::DataWriter* catalogue_blocks, const BlockWriter::Stream& stream,
            std::function<void()> on_reader, const std::function<void()>& on_match);

  BusCatalogue catalogue;
  BlockWriter blocks;  // keeps the last values, for both
  SampleWriters samples;
  std::map<std::string, idl::DeviceStatus> devices;                 // published at least once
  std::map<std::pair<ChannelIndex, LimitKind>, idl::Alarm> alarms;  // raised at least once
  std::map<AlarmKey, idl::AlarmStatus> alarm_status;                // published at least once
  idl::BusStatus status;
  std::vector<idl::ReadPlan> plan;  // its parts, as published
  bool reported = false;
  bool write_failed = false;
};

struct DdsLink::State {
  using Commands = RequestReceiver<idl::Command>;
  using Actions = RequestReceiver<idl::AlarmAction>;
  // Of what is asked by all, or by members that are held to one bus.
  struct Receivers {
    std::unique_ptr<Commands> commands;
    std::unique_ptr<Actions> actions;  // if they are wanted

    void close() const;
  };

  State(const DdsSpec& spec, const std::string& name, Handlers given);

  // On the thread of snapshots: what changed in the catalogue, then the last values.
  SnapshotSender::Sent send_snapshot(const std::string& name, SnapshotSender::Part part);

  bool is_ours(const std::string& name);
  template <class Message>
  RequestHandlers<Message> request_handlers();
  void accept(const idl::Command& message, RequestTerms terms);
  void accept(const idl::AlarmAction& message, const RequestTerms& terms);
  Receivers listen(const HeldTo& bus);
  // What is nothing for a bus engine, or for the alarms, is answered here.
  template <class Message>
  void reject(const Message& message, const MalformedCommand& why);

  // The bus, or null. REQUIRES: mutex held, shared or not.
  LinkedBus* find(std::string_view name);
  void dispose(LinkedBus& bus, Duration linger, Duration limit = kInfinite);
  // Made before, or now.
  std::unique_ptr<LinkedBus> made(const BusSpec& spec);
  void serve(const std::string& name, std::unique_ptr<LinkedBus> bus);
  void listen_for(const std::string& bus);

  const std::string bridge;
  const Handlers handlers;
  RequestWriters writers;
  Domain domain;
  const std::size_t block_bytes;
  ResultSender results;
  dds::DataWriter* catalogue_blocks = nullptr;
  dds::DataWriter* bus_status = nullptr;
  dds::DataWriter* device_status = nullptr;
  dds::DataWriter* sessions = nullptr;
  dds::DataWriter* alarms = nullptr;
  dds::DataWriter* alarm_status = nullptr;
  dds::DataWriter* plans = nullptr;
  std::unique_ptr<InterestReceiver> interests;
  Receivers receivers;  // since listen_for_commands()
  // The same for members that are held to a bus, since it was added: by bus.
  std::map<std::string, Receivers, std::less<>> held;
  std::unique_ptr<BridgePresence> presence;
  std::shared_mutex mutex;  // the set of buses: shared to use one, alone to add or remove one
  std::map<std::string, std::unique_ptr<LinkedBus>, std::less<>> buses;
  std::map<std::string, std::unique_ptr<LinkedBus>, std::less<>> prepared;
  std::atomic<bool> standing_by = false;
  // Of the buses, once more: a thread of the library asks for them and holds locks of its own,
  // which whoever holds `mutex` may wait for when it makes a writer. Nothing is called under it.
  std::mutex names_mutex;
  std::set<std::string, std::less<>> names;
  bool closed = false;
  std::unique_ptr<SnapshotSender> snapshots;  // last: its thread uses the buses
};

}  // namespace fieldcast
