#include "core/error.h"
#include "scene/light_text.h"
#include <gtest/gtest.h>

namespace lumel::scene {
namespace {

TEST(LightText, GivesTheSameLightAgain)
{
    for (const char* text : {"sun,0.3,-0.9,0.1,1,0.94,0.84,2.65", "point,1.5,-2e-3,7,0.1,0.2,0.3,40",
                             "point,1,2,3,1,1,1,40,12.5", "spot,0,3,0,1,1,1,900,0,0.1,-1,0.2,12.3,34.567"}) {
        const Light light = parseLight(text);
        EXPECT_EQ(parseLight(lightText(light)), light) << text << " -> " << lightText(light);
    }
}

TEST(LightText, ReadsUnits)
{
    const Light spot = parseLight("spot,1,2,3,0.5,0.25,0,900,8,0,-2,0,30,45");
    EXPECT_EQ(spot.type, LightType::spot);
    EXPECT_EQ(spot.position, glm::vec3(1, 2, 3));
    EXPECT_EQ(spot.colour, glm::vec3(0.5f, 0.25f, 0.0f));
    EXPECT_EQ(spot.intensity, 900.0f);
    EXPECT_EQ(spot.range, 8.0f);
    EXPECT_EQ(spot.direction, glm::vec3(0, -1, 0));
    EXPECT_FLOAT_EQ(spot.innerCone, glm::radians(30.0f));
    EXPECT_FLOAT_EQ(spot.outerCone, glm::radians(45.0f));
}

TEST(LightText, RefusesWhatIsNoLight)
{
    for (const char* text :
         {"", "sun", "lamp,1,2,3,1,1,1,1", "sun,0,0,0,1,1,1,1", "sun,0,-1,0,1,1,1", "point,1,2,x,1,1,1,1",
          "point,1,2,3,1,1,1,1,", "point,nan,2,3,1,1,1,1", "sun,0,-1,0,-1,1,1,1", "sun,0,-1,0,1,1,1,-2",
          "spot,0,0,0,1,1,1,1,0,0,-1,0,40,30"})
        EXPECT_THROW(parseLight(text), Error) << text;
}

} // namespace
} // namespace lumel::scene
