/* A station on Cyclone DDS that joins late, for tools/bench/join_bench: reads the catalogue and all
 * samples, and prints the counts every 20 ms, as bench_station does.
 *
 * usage: cyclone-join DOMAIN one-by-one|by-blocks
 *
 * one-by-one: fieldcast/Channel and fieldcast/Sample. by-blocks: fieldcast/CatalogueBlock and
 * fieldcast/SampleBlock, with a request for a snapshot if blocks or last values are missing.
 * Each line: samples received, 0, channels with a value, channels of the catalogue, blocks missing.
 * Runs until SIGTERM. Uses the loopback unless CYCLONEDDS_URI is set. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "station.h"

enum { kAtOnce = 64, kInstances = 1 << 18, kBuses = 1024, kMaxChannels = 100000 };

static const char* const kLoopback =
    "<CycloneDDS><Domain><General><Interfaces>"
    "<NetworkInterface name=\"lo\" multicast=\"true\"/>"
    "</Interfaces></General></Domain></CycloneDDS>";

static uint64_t samples_received, channels_listed, channels_with_value, blocks_missing;

/* ---- one by one */

/* Known instances: open addressing; 0 is a free slot. */
struct instances {
  dds_instance_handle_t handles[kInstances];
};

static bool is_new(struct instances* seen, dds_instance_handle_t handle) {
  size_t at = (size_t)((handle * UINT64_C(0x9E3779B97F4A7C15)) >> 46);
  for (; seen->handles[at] != 0; at = (at + 1) % kInstances) {
    if (seen->handles[at] == handle) return false;
  }
  seen->handles[at] = handle;
  return true;
}

/* Takes all available samples. Returns their number; counts the new instances. */
static uint64_t take_instances(dds_entity_t reader, struct instances* seen, uint64_t* instances) {
  void* messages[kAtOnce] = {NULL};
  dds_sample_info_t infos[kAtOnce];
  uint64_t taken = 0;
  for (dds_return_t n; (n = dds_take(reader, messages, infos, kAtOnce, kAtOnce)) > 0;
       dds_return_loan(reader, messages, n)) {
    for (dds_return_t i = 0; i < n; ++i) {
      if (!infos[i].valid_data) continue;
      ++taken;
      if (is_new(seen, infos[i].instance_handle)) ++*instances;
    }
  }
  return taken;
}

/* ---- by blocks */

struct bus {
  fieldcast_Name name;
  uint64_t epoch, last_number;
  bool hole, snapshot; /* blocks are missing; a snapshot was received */
  dds_time_t due;      /* the next request for a snapshot */
  uint32_t channels;
  uint8_t *listed, *with_value; /* of each channel */
};

static struct bus buses[kBuses];
static size_t bus_count;

static void grow(struct bus* bus, uint32_t channels) {
  if (channels <= bus->channels) return;
  uint8_t* listed = realloc(bus->listed, channels);
  uint8_t* with_value = realloc(bus->with_value, channels);
  if (listed == NULL || with_value == NULL) abort();
  memset(listed + bus->channels, 0, channels - bus->channels);
  memset(with_value + bus->channels, 0, channels - bus->channels);
  bus->listed = listed, bus->with_value = with_value, bus->channels = channels;
}

/* Returns the bus in this epoch; null for an old epoch or too many buses. A newer epoch does not
 * reset the counts, because the benchmark does not restart its bridge. */
static struct bus* bus_of(const char* name, uint64_t epoch) {
  size_t i = 0;
  while (i < bus_count && strcmp(buses[i].name, name) != 0) ++i;
  if (i == kBuses) return NULL;
  if (i == bus_count) {
    ++bus_count;
    snprintf(buses[i].name, sizeof buses[i].name, "%s", name);
    buses[i].epoch = epoch;
    buses[i].due = dds_time() + DDS_MSECS(300);
  }
  return buses[i].epoch == epoch ? &buses[i] : NULL;
}

static void list(const fieldcast_CatalogueBlock* block) {
  struct bus* bus = bus_of(block->bus, block->epoch);
  if (bus == NULL) return;
  grow(bus, block->channels < kMaxChannels ? block->channels : kMaxChannels);
  for (uint32_t i = 0; i < block->entries._length && block->first + i < bus->channels; ++i) {
    if (bus->listed[block->first + i]) continue;
    bus->listed[block->first + i] = 1;
    ++channels_listed;
  }
}

static void receive(const fieldcast_SampleBlock* block) {
  struct bus* bus = bus_of(block->bus, block->epoch);
  if (bus == NULL) return;
  if (bus->last_number != 0 && block->number > bus->last_number + 1) {
    blocks_missing += block->number - bus->last_number - 1;
    bus->hole = true;
  }
  bus->last_number = block->number;
  if (block->snapshot) bus->snapshot = true, bus->hole = false;
  for (uint32_t i = 0; i < block->channels._length; ++i) {
    const uint32_t channel = block->channels._buffer[i];
    if (channel >= kMaxChannels) continue;
    grow(bus, channel + 1);
    ++samples_received;
    if (bus->with_value[channel]) continue;
    bus->with_value[channel] = 1;
    ++channels_with_value;
  }
}

/* Takes all available samples of CatalogueBlock or SampleBlock. */
static void take_blocks(dds_entity_t reader, bool catalogue) {
  void* blocks[kAtOnce] = {NULL};
  dds_sample_info_t infos[kAtOnce];
  for (dds_return_t n; (n = dds_take(reader, blocks, infos, kAtOnce, kAtOnce)) > 0;
       dds_return_loan(reader, blocks, n)) {
    for (dds_return_t i = 0; i < n; ++i) {
      if (!infos[i].valid_data) continue;
      catalogue ? list(blocks[i]) : receive(blocks[i]);
    }
  }
}

static void ask_for_snapshots(dds_entity_t writer) {
  for (size_t i = 0; i < bus_count; ++i) {
    if ((buses[i].snapshot && !buses[i].hole) || buses[i].due > dds_time()) continue;
    buses[i].due = dds_time() + DDS_MSECS(300);
    fieldcast_SnapshotRequest request = {.station = "cyclone-join"};
    memcpy(request.bus, buses[i].name, sizeof request.bus);
    need(dds_write(writer, &request), "request");
  }
}

/* ---- */

static dds_entity_t waited_for(dds_entity_t reader, dds_entity_t waitset) {
  dds_waitset_attach(waitset, need(dds_create_readcondition(reader, DDS_ANY_STATE), "condition"),
                     0);
  return reader;
}

static void say(void) {
  static dds_time_t due;
  if (dds_time() < due) return;
  due = dds_time() + DDS_MSECS(20);
  printf("%" PRIu64 " 0 %" PRIu64 " %" PRIu64 " %" PRIu64 "\n", samples_received,
         channels_with_value, channels_listed, blocks_missing);
  fflush(stdout);
}

static void join_one_by_one(dds_entity_t participant, dds_entity_t waitset) {
  static struct instances listed, with_value; /* zeroed */
  dds_qos_t* qos = state_qos(0);
  const dds_entity_t channels = waited_for(
      reader_of(participant, &fieldcast_Channel_desc, "fieldcast/Channel", qos), waitset);
  const dds_entity_t samples =
      waited_for(reader_of(participant, &fieldcast_Sample_desc, "fieldcast/Sample", qos), waitset);
  dds_delete_qos(qos);
  for (; !stopped(); say()) {
    dds_waitset_wait(waitset, NULL, 0, DDS_MSECS(20));
    take_instances(channels, &listed, &channels_listed);
    samples_received += take_instances(samples, &with_value, &channels_with_value);
  }
}

static void join_by_blocks(dds_entity_t participant, dds_entity_t waitset) {
  dds_qos_t* qos = state_qos(0);
  const dds_entity_t catalogue = waited_for(
      reader_of(participant, &fieldcast_CatalogueBlock_desc, "fieldcast/CatalogueBlock", qos),
      waitset);
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  const dds_entity_t requests =
      writer_of(participant, &fieldcast_SnapshotRequest_desc, "fieldcast/SnapshotRequest", qos);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1024);
  const dds_entity_t samples = waited_for(
      reader_of(participant, &fieldcast_SampleBlock_desc, "fieldcast/SampleBlock", qos), waitset);
  dds_delete_qos(qos);
  for (; !stopped(); say()) {
    dds_waitset_wait(waitset, NULL, 0, DDS_MSECS(20));
    take_blocks(catalogue, true);
    take_blocks(samples, false);
    ask_for_snapshots(requests);
  }
}

int main(int argc, char** argv) {
  if (argc < 3) {
    fprintf(stderr, "usage: cyclone-join DOMAIN one-by-one|by-blocks\n");
    return 2;
  }
  setenv("CYCLONEDDS_URI", kLoopback, 0);
  const dds_entity_t participant = participant_in(argv[1]);
  const dds_entity_t waitset = need(dds_create_waitset(participant), "waitset");
  strcmp(argv[2], "one-by-one") == 0 ? join_one_by_one(participant, waitset)
                                     : join_by_blocks(participant, waitset);
  dds_delete(participant);
  return 0;
}
