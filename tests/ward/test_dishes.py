import mala_drake.ward.dishes as mut


def test_the_dishes_are_those_of_the_hospital_case():
    recipes = {name: set(dish.ingredients) for name, dish in mut.DISHES.items()}
    assert recipes == {
        "sandwich": {"bread", "vegetables"},
        "salad": {"nuts", "vegetables"},
        "hot_meal": {"chicken", "vegetables"},
    }
    assert [dish.name for dish in mut.DISHES.values() if dish.cooked] == ["hot_meal"]


def test_the_better_a_dish_looks_the_more_it_takes():
    sandwich, salad, hot_meal = (mut.DISHES[name] for name in ("sandwich", "salad", "hot_meal"))
    assert sandwich.presentation_error > salad.presentation_error > hot_meal.presentation_error >= 0.0
    assert salad.assembling > sandwich.assembling


def test_nobody_asks_of_medicine_that_it_looks_good():
    assert mut.presentation_error("") == mut.presentation_error("med_insulin") == 0.0
    assert mut.presentation_error("salad") == mut.DISHES["salad"].presentation_error
