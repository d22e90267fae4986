#include "shading/closures/principled.h"

#include "closure_checks.h"

namespace fathom::test {
namespace {

TEST(Principled, SamplingAndEnergy)
{
    for (double degrees : {0.0, 45.0, 80.0})
        for (float metallic : {0.0f, 0.5f, 1.0f}) {
            check_sampling(PrincipledBsdf(material(0.6f, 0.5f, metallic)), degrees, "principled");
            for (float roughness : {0.1f, 0.5f, 1.0f}) {
                const double albedo =
                    draw(PrincipledBsdf(material(1, roughness, metallic)), outgoing(degrees), 200000).albedo;
                EXPECT_LT(albedo, 1.02) << degrees << " " << metallic << " " << roughness;
                EXPECT_GT(albedo, metallic == 1 ? 0.98 : 0.7) << degrees << " " << metallic << " " << roughness;
            }
        }
}

}  // namespace
}  // namespace fathom::test
