// The average of level 0's GGX lobes under a texel, at nodes of its own.
#pragma once
#include "baker/footprint.h"
#include "ggx.h"

namespace lumel::baker {

// Level 0 as lobes.
struct GgxBase {
    int width = 0, height = 0;
    std::vector<GgxTexel> texels;
    std::vector<GgxTerm> lobes;
    bool isIsotropic = true;
    const GgxTexel& at(int x, int y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
    const GgxTerm& lobeAt(int x, int y) const { return lobes[size_t(y) * size_t(width) + size_t(x)]; }
};

// Means over the level-0 texels under one texel.
struct GgxMeans {
    glm::vec3 f0{0.0f};
    float strength = 0.0f; // luminance of F0, by which lobes are weighted; 1 where all are black
    bool isBlack = false;
    float alphaSquared = 0.0f; // weighted by strength
    GgxShape averaged;         // as an engine averages maps: the mean normal and mean roughness
    glm::mat3 diffuse{0.0f};   // of each colour, the mean of reflectance times normal
    // What a texel of this normal keeps of it.
    glm::vec3 diffuseAlong(glm::vec3 normal) const { return glm::max(normal * diffuse, 0.0f); }
};

class GgxAverage {
public:
    explicit GgxAverage(const GgxBase& base) : base_(base) {}

    // Of texel (x, y) of a level of this size.
    GgxMeans means(int x, int y, int width, int height);
    // Of the texel of the last means(): the average at nodes drawn from it, from a lobe twice as rough as
    // `near` and evenly from the disc, a third each, with the weights by which they are summed (importance
    // sampling of a mixture). Where there are many lobes, of some of them.
    void sum(const GgxMeans& means, const GgxShape& near);

    // Error of what a display shows of strength * lobe, relative to the square of what it shows of the
    // average.
    double error(const GgxMeans& means, const GgxShape& shape) const;

private:
    template<class Use>
    void forTexels(const Use& use) const;
    template<class Use>
    void forSomeTexels(const Use& use) const;
    void collect(const GgxMeans& means);
    GgxNodes::Lobes pick(const GgxMeans& means) const;

    const GgxBase& base_;
    Footprint columns_{0.0, 1.0}, rows_{0.0, 1.0};
    std::vector<GgxTerm> terms_;          // those that are averaged, each times what it reflects
    std::vector<const GgxShape*> shapes_; // the same
    std::vector<float> strengths_;        // what they reflect: in all, the mean's strength
    GgxNodes nodes_;
    GgxNodes::Values shown_{}, weights_{}; // shown_: of the average
    double square_ = 0.0;                  // of shown_
};

float luminanceOf(glm::vec3 colour);
glm::vec3 luminanceOf(const glm::mat3& vectors); // of a vector a colour

} // namespace lumel::baker
