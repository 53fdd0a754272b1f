#include "splat/layer_switch.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "splat/rasterizer.h"
#include "splat/reference.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

constexpr PlaneStates kStates{200, 850.5f, 1.25f, true};

TEST(LayerSwitch, APlaneGoesThroughOneSlabAndAStatesOwnThroughItsOwn) {
  for (const bool below : {true, false}) {
    PlaneStates states = kStates;
    states.keeps_below = below;
    const float into = below ? -1.0f : 1.0f;  // the kept side
    for (int k = 0; k < states.count; ++k) {
      EXPECT_EQ(states.slab_at(states.position(k)), k);
      EXPECT_EQ(states.slab_at(states.position(k) + into * 0.3f), k);
      EXPECT_EQ(states.slab_at(states.position(k) + into * 1.2f), k);
      EXPECT_EQ(states.slab_at(states.position(k) + into * 1.3f), k + (below ? -1 : 1));
      // Where a centre's slab is, a plane just there goes through the same.
      const float inside = states.position(k) + into * 0.6f;
      EXPECT_EQ(states.nearest_slab(inside), states.slab_at(inside));
    }
    EXPECT_EQ(states.slab_at(states.position(0) - 40 * states.spacing), -40);
    EXPECT_EQ(states.slab_at(states.position(199) + 40 * states.spacing), 239);
  }
}

TEST(LayerSwitch, SwitchesTheSideThatStatesRemoveOff) {
  Scene scene = layered_scene(3, 0, 1);
  scene.states = kStates;
  scene.layers = {99, 100, 101};
  for (const bool below : {true, false}) {
    scene.states.keeps_below = below;
    const Plane plane = scene.states.plane(scene.axis, scene.states.position(100));
    const LayerSwitch layers = switch_layers(scene, plane);
    EXPECT_EQ(layers.part(0), below ? LayerPart::kWhole : LayerPart::kOff);
    EXPECT_EQ(layers.part(1), LayerPart::kCut);
    EXPECT_EQ(layers.part(2), below ? LayerPart::kOff : LayerPart::kWhole);
  }
}

TEST(LayerSwitch, RefusesOtherCutsAndScenesWithoutLayers) {
  Scene scene = layered_scene(30, 0, 1);
  const Plane plane = scene.states.plane(scene.axis, scene.states.position(9));
  EXPECT_TRUE(switches_layers(scene, plane));
  EXPECT_TRUE(switches_layers(scene, Cut()));
  const Plane oblique{glm::normalize(plane.normal + Vec3(0.02f, 0, 0)), plane.offset};
  const Plane back = scene.states.plane(scene.axis, scene.states.position(3)).flipped();
  for (const Cut& cut : {Cut(plane.flipped()), Cut(oblique), Cut(std::vector{plane, back})}) {
    EXPECT_FALSE(switches_layers(scene, cut));
    EXPECT_THROW(switch_layers(scene, cut), Error);
  }
  EXPECT_NO_THROW(switch_layers(scene, plane));
  scene.layers.clear();
  EXPECT_THROW(switch_layers(scene, plane), Error);
}

class LayersPicture : public testing::Test {
 protected:
  LayersPicture() : scene_(layered_scene(600, 1, 5)) {
    for (size_t i = 0; i < scene_.layers.size(); ++i) {
      for (int a = 0; a < 3; ++a) {  // large enough to reach over several slabs
        scene_.gaussians.plane(Gaussians::kLogScale + a)[i] += 1.5f;
      }
    }
    camera_ = frame_sphere(scene_.sphere, Vec3(0.2f, 0.5f, 0.8f), 1, 80,
                           64);  // no plane is seen along itself
    plane_ = scene_.states.plane(scene_.axis, scene_.states.position(97));
  }

  Image draw(const Scene& scene, const Cut& cut, ClipOperator clip) const {
    const LayerSwitch layers =
        clip == ClipOperator::kLayers ? switch_layers(scene, cut) : LayerSwitch();
    return render(scene.gaussians, camera_, cut, clip, nullptr, {}, layers);
  }

  Scene scene_;
  Camera camera_;
  Plane plane_;
};

TEST_F(LayersPicture, IsTheReferences) {
  const LayerSwitch layers = switch_layers(scene_, plane_);
  const Image fast = draw(scene_, plane_, ClipOperator::kLayers);
  const Image slow = render_reference(scene_.gaussians, camera_, plane_, ClipOperator::kLayers,
                                      nullptr, {}, layers);
  double light = 0;
  for (size_t i = 0; i < fast.data.size(); i += 4) {
    light += fast.data[i + 3];
    for (size_t c = 0; c < 4; ++c) {
      const float alpha = c < 3 ? fast.data[i + 3] : 1;
      EXPECT_NEAR(alpha * fast.data[i + c], alpha * slow.data[i + c], 2.0f / 255);
    }
  }
  EXPECT_GT(light, 100);
}

TEST_F(LayersPicture, IsTheExactOneWhereAllLayersAreCutAndTheUncutWhereNoneIs) {
  const std::vector<std::uint16_t> own = scene_.layers;
  scene_.layers.assign(own.size(), 97);
  EXPECT_EQ(draw(scene_, plane_, ClipOperator::kLayers).data,
            draw(scene_, plane_, ClipOperator::kExact).data);
  scene_.layers.assign(own.size(), 96);
  EXPECT_EQ(draw(scene_, plane_, ClipOperator::kLayers).data,
            draw(scene_, Cut(), ClipOperator::kExact).data);
  scene_.layers.assign(own.size(), 98);
  for (const float v : draw(scene_, plane_, ClipOperator::kLayers).data) {
    EXPECT_EQ(v, 0);
  }
}

TEST_F(LayersPicture, DrawsWholeWhatTheOthersCut) {
  // Half of the Gaussians are off and half whole: the picture is that of the whole half, uncut.
  Scene whole = scene_;
  std::vector<size_t> kept;
  for (size_t i = 0; i < scene_.layers.size(); ++i) {
    scene_.layers[i] = static_cast<std::uint16_t>(i % 2 == 0 ? 80 : 130);
    if (i % 2 == 0) {
      kept.push_back(i);
    }
  }
  whole.gaussians = scene_.gaussians.like(kept.size());
  for (int p = 0; p < whole.gaussians.planes(); ++p) {
    for (size_t n = 0; n < kept.size(); ++n) {
      whole.gaussians.plane(p)[n] = scene_.gaussians.plane(p)[kept[n]];
    }
  }
  EXPECT_EQ(draw(scene_, plane_, ClipOperator::kLayers).data,
            draw(whole, Cut(), ClipOperator::kExact).data);
}

}  // namespace
}  // namespace clipgs
