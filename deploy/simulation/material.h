// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

// Procedural grey albedo. Every material has detail from metres down to a few millimetres; what is finer than a pixel
// is removed by the texture pyramid (texture.h).
namespace coslam::sim {

enum class MaterialKind : std::uint8_t {
  kBrick,
  kPlaster,
  kPlanks,
  kTiles,
  kCeiling,
  kWood,
  kFabric,
  kRug,
  kCarton,
  kPoster,
  kPicture,
  kNewspaper,
  kBookSpine,
  kPages,
  kScreen,
  kLeaf,
  kFoliage,
  kPaint,
  kLamp,
  kCheckedCloth,
  kPrintedCloth,
  kStripedCloth,
  kDenim,
  kFace,
  kHand,
  kShoe,
  kTag,
};

struct Material {
  MaterialKind kind = MaterialKind::kPlaster;
  std::uint32_t seed = 0;
  float tone = 0.5F;  // mean albedo; for prints the paper's
};

// A place on a facet: metres from its upper left corner, and the facet's size for prints that have a layout.
struct SurfacePoint {
  float u_m = 0, v_m = 0;
  float width_m = 0, height_m = 0;
};

// Albedo in [0.02, 0.95].
float albedo(const Material& material, const SurfacePoint& p);

// One function a kind; surfaces (material_surface.cpp) repeat over any size, prints (material_print.cpp) fill the
// facet, and what people wear (material_clothes.cpp) goes around a part.
float brick_albedo(const Material& m, const SurfacePoint& p);
float plaster_albedo(const Material& m, const SurfacePoint& p);
float planks_albedo(const Material& m, const SurfacePoint& p);
float tiles_albedo(const Material& m, const SurfacePoint& p);
float ceiling_albedo(const Material& m, const SurfacePoint& p);
float wood_albedo(const Material& m, const SurfacePoint& p);
float fabric_albedo(const Material& m, const SurfacePoint& p);
float paint_albedo(const Material& m, const SurfacePoint& p);
float rug_albedo(const Material& m, const SurfacePoint& p);
float foliage_albedo(const Material& m, const SurfacePoint& p);
float leaf_albedo(const Material& m, const SurfacePoint& p);
float carton_albedo(const Material& m, const SurfacePoint& p);
float poster_albedo(const Material& m, const SurfacePoint& p);
float picture_albedo(const Material& m, const SurfacePoint& p);
float newspaper_albedo(const Material& m, const SurfacePoint& p);
float book_spine_albedo(const Material& m, const SurfacePoint& p);
float pages_albedo(const Material& m, const SurfacePoint& p);
float screen_albedo(const Material& m, const SurfacePoint& p);
float checked_cloth_albedo(const Material& m, const SurfacePoint& p);
float printed_cloth_albedo(const Material& m, const SurfacePoint& p);
float striped_cloth_albedo(const Material& m, const SurfacePoint& p);
float denim_albedo(const Material& m, const SurfacePoint& p);
float face_albedo(const Material& m, const SurfacePoint& p);
float hand_albedo(const Material& m, const SurfacePoint& p);
float shoe_albedo(const Material& m, const SurfacePoint& p);
// A tag with a margin of one of its cells around; its id is kPrintedTag.
float tag_albedo(const Material& m, const SurfacePoint& p);
inline constexpr int kPrintedTag = 0;  // id in the family AprilTag 36h11
inline constexpr int kTagCells = 8;    // a side, black border included

}  // namespace coslam::sim
