/* SPDX-FileCopyrightText: 2026 The CoSLAM authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * cyclone_node DOMAIN TOPIC...: a node made with Cyclone DDS and the code that it generates. Prints what it hears first
 * on each topic ("odom NAME", "cloud NAME", "px4 NAME", "text NAME"), a line each; exit code 0 when that is all of them.
 */
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ros2.h"

enum { kMostTopics = 8, kWaits = 60 };

typedef struct {
  const char *kind;
  dds_entity_t reader;
  int heard;
} Topic;

static void print_odom(const nav_msgs_msg_dds__Odometry_ *m) {
  const geometry_msgs_msg_dds__Pose_ *p = &m->pose.pose;
  printf("odom %d.%09u %s %s %g %g %g %g %g\n", m->header.stamp.sec, m->header.stamp.nanosec, m->header.frame_id,
         m->child_frame_id, p->position.x, p->position.y, p->position.z, p->orientation.w, m->pose.covariance[35]);
}

static void print_cloud(const sensor_msgs_msg_dds__PointCloud2_ *m) {
  float x = 0;
  if (m->data._length >= 4) memcpy(&x, m->data._buffer, 4);
  printf("cloud %s %u %u %u %s %g\n", m->header.frame_id, m->width, m->fields._length, m->data._length,
         m->fields._length > 0 ? m->fields._buffer[0].name : "-", x);
}

static void print_px4(const px4_msgs_msg_dds__VehicleOdometry_ *m) {
  printf("px4 %d %g %g %g %g %d %d\n", m->pose_frame, m->position[0], m->position[1], m->position[2], m->q[0],
         m->reset_counter, (int)m->quality);
}

static const dds_topic_descriptor_t *type_of(const char *kind) {
  if (strcmp(kind, "odom") == 0) return &nav_msgs_msg_dds__Odometry__desc;
  if (strcmp(kind, "cloud") == 0) return &sensor_msgs_msg_dds__PointCloud2__desc;
  if (strcmp(kind, "px4") == 0) return &px4_msgs_msg_dds__VehicleOdometry__desc;
  if (strcmp(kind, "text") == 0) return &std_msgs_msg_dds__String__desc;
  fprintf(stderr, "cyclone_node: no kind of topic: %s\n", kind);
  exit(2);
}

/* As nodes subscribe: sensor data at best effort, maps reliable and with the newest for who comes late. */
static dds_qos_t *qos_of(const char *kind) {
  dds_qos_t *qos = dds_create_qos();
  const int map = strcmp(kind, "cloud") == 0, text = strcmp(kind, "text") == 0;
  dds_qset_reliability(qos, map || text ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_durability(qos, map ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, map ? 1 : 5);
  return qos;
}

static Topic open_topic(dds_entity_t participant, const char *kind, const char *name) {
  Topic topic = {kind, 0, 0};
  const dds_entity_t dds_topic = dds_create_topic(participant, type_of(kind), name, NULL, NULL);
  dds_qos_t *qos = qos_of(kind);
  topic.reader = dds_topic < 0 ? dds_topic : dds_create_reader(participant, dds_topic, qos, NULL);
  dds_delete_qos(qos);
  if (topic.reader >= 0) return topic;
  fprintf(stderr, "cyclone_node: %s: %s\n", name, dds_strretcode(topic.reader));
  exit(1);
}

static void take(Topic *topic) {
  void *samples[1] = {NULL};
  dds_sample_info_t info[1];
  while (dds_take(topic->reader, samples, info, 1, 1) > 0) {
    if (info[0].valid_data && !topic->heard) {
      topic->heard = 1;
      if (strcmp(topic->kind, "odom") == 0) print_odom(samples[0]);
      if (strcmp(topic->kind, "cloud") == 0) print_cloud(samples[0]);
      if (strcmp(topic->kind, "px4") == 0) print_px4(samples[0]);
      if (strcmp(topic->kind, "text") == 0) printf("text %s\n", ((std_msgs_msg_dds__String_ *)samples[0])->data);
      fflush(stdout);
    }
    dds_return_loan(topic->reader, samples, 1);
  }
}

int main(int argc, char **argv) {
  Topic topics[kMostTopics];
  int count = 0, heard = 0, i, waited;
  dds_entity_t participant;
  if (argc < 4 || argc % 2 != 0 || (argc - 2) / 2 > kMostTopics) {
    fprintf(stderr, "usage: cyclone_node DOMAIN (odom|cloud|px4|text NAME)...\n");
    return 2;
  }
  participant = dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL);
  if (participant < 0) {
    fprintf(stderr, "cyclone_node: %s\n", dds_strretcode(participant));
    return 1;
  }
  for (i = 2; i < argc; i += 2) topics[count++] = open_topic(participant, argv[i], argv[i + 1]);
  for (waited = 0; waited < kWaits * 20 && heard < count; ++waited) {
    heard = 0;
    for (i = 0; i < count; ++i) {
      take(&topics[i]);
      heard += topics[i].heard;
    }
    dds_sleepfor(DDS_MSECS(50));
  }
  dds_delete(participant);
  return heard == count ? 0 : 1;
}
